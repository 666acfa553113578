"""Newtonian flow between two plates: start-up from rest and the parabola that it comes to."""

import math
from typing import Any

import numpy as np

from grainlaw.validation.case import Case, Effort, Evidence, Measurement
from grainlaw.validation.cases.exact.viscous_flow import ViscousFlow

HEIGHT, DENSITY, VISCOSITY, BULK_MODULUS, PRESSURE = 1.0, 1000.0, 100.0, 1e5, 1e4
ACCELERATION = 0.01
CELLS = {Effort.QUICK: (20,), Effort.FULL: (10, 20, 40)}
# The slowest mode decays over rho H^2/(pi^2 eta) = 1.01 s.
TIMES = {"start": 0.3, "steady": 6.0}
# Terms of the series, beyond which it is below 1e-6 at the first time.
TERMS = 15


def exact_velocity(y: Any, time: float) -> Any:
    """Velocity [m/s] at a height y [m] above the lower plate, t [s] after the start."""
    scale = DENSITY * ACCELERATION * HEIGHT**2 / VISCOSITY
    z = np.asarray(y) / HEIGHT
    found = 0.5 * z * (1.0 - z)
    for n in range(1, 2 * TERMS, 2):
        decay = math.exp(-((n * math.pi) ** 2) * VISCOSITY * time / (DENSITY * HEIGHT**2))
        found = found - 4.0 / (n * math.pi) ** 3 * np.sin(n * math.pi * z) * decay
    return scale * found


def scene(cells: int, viscosity: float) -> dict[str, Any]:
    """Four cells of a layer that is periodic along the plates, under a pressure that keeps it from opening."""
    size = HEIGHT / cells
    return {
        "gravity": [ACCELERATION, 0.0],
        "grid": {"cell_size": size, "upper": [4.0 * size, HEIGHT]},
        "boundary": {"left": "periodic", "right": "periodic", "bottom": "no_slip", "top": "no_slip"},
        "time": {"end": TIMES["steady"], "step": 0.1 * DENSITY * size**2 / VISCOSITY / 4.0},
        "material": {"newtonian": {"viscosity": viscosity, "bulk_modulus": BULK_MODULUS}},
        "body": [
            {
                "material": "newtonian",
                "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [4.0 * size, HEIGHT]},
                "density": DENSITY,
                "initial_stress": {"kind": "uniform", "pressure": PRESSURE},
            }
        ],
    }


FLOW = ViscousFlow(
    scene, exact_velocity, TIMES, across=1, width=HEIGHT, fastest=0.5 * HEIGHT, place=("height", "between the plates")
)


def measure(effort: Effort) -> Evidence:
    """The layer on ever finer grids."""
    return FLOW.evidence({cells: FLOW.profiles(cells, VISCOSITY) for cells in CELLS[effort]})


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The convention s = eta D_d, in which eta counts half of the velocity gradient."""
    return FLOW.measurements(FLOW.profiles(CELLS[Effort.QUICK][0], 0.5 * VISCOSITY))


CASE = Case(
    name="poiseuille",
    title="Newtonian flow between plates, from rest",
    proves="viscous forces and walls that hold the fluid: the one continuum flow that is known in space and time",
    reference="u = rho g H^2/eta (z (1 - z)/2 - sum over odd n of 4/(n pi)^3 sin(n pi z) "
    "exp(-(n pi)^2 eta t/(rho H^2))), z = y/H",
    norm="largest error over the points, over the largest velocity",
    mistake="half the viscosity, as in s = eta D_d",
    measure=measure,
    control=control,
)
