"""Newtonian flow through a pipe, from rest to the parabola of Hagen and Poiseuille."""

from typing import Any

import numpy as np
from scipy.special import j0, j1, jn_zeros

from grainlaw.validation.case import Case, Effort, Evidence, Measurement
from grainlaw.validation.cases.exact.viscous_flow import ViscousFlow
from grainlaw.validation.scenes import block

RADIUS, DENSITY, VISCOSITY, BULK_MODULUS, PRESSURE = 1.0, 1000.0, 200.0, 1e5, 1e4
ACCELERATION = 0.02
CELLS = {Effort.QUICK: (10,), Effort.FULL: (10, 20, 40)}
# The slowest mode decays over rho R^2/(5.78 eta) = 0.86 s.
TIMES = {"start": 0.3, "steady": 5.0}
# Terms of the series, beyond which it is below 1e-6 at the first time.
TERMS = 20


def exact_velocity(radius: Any, time: float) -> Any:
    """Velocity [m/s] along the pipe at a radius [m], t [s] after the start (Szymanski 1932)."""
    scale = DENSITY * ACCELERATION * RADIUS**2 / (4.0 * VISCOSITY)
    x = np.asarray(radius) / RADIUS
    found = 1.0 - x**2
    for zero in jn_zeros(0, TERMS):
        decay = np.exp(-(zero**2) * VISCOSITY * time / (DENSITY * RADIUS**2))
        found = found - 8.0 * j0(zero * x) / (zero**3 * j1(zero)) * decay
    return scale * found


def scene(cells: int, viscosity: float) -> dict[str, Any]:
    """Four cells of a pipe that is periodic along its axis, under a pressure that keeps the fluid from opening."""
    size = RADIUS / cells
    domain = [RADIUS, 4.0 * size]
    return {
        "space": "axisymmetric",
        "gravity": [0.0, ACCELERATION],
        "grid": {"cell_size": size, "upper": domain},
        "boundary": {"right": "no_slip", "bottom": "periodic", "top": "periodic"},
        "time": {"end": TIMES["steady"], "step": 0.1 * DENSITY * size**2 / VISCOSITY / 4.0},
        "material": {"newtonian": {"viscosity": viscosity, "bulk_modulus": BULK_MODULUS}},
        "body": [
            {
                "material": "newtonian",
                "shape": block([0.0, 0.0], domain),
                "density": DENSITY,
                "initial_stress": {"kind": "uniform", "pressure": PRESSURE},
            }
        ],
    }


FLOW = ViscousFlow(scene, exact_velocity, TIMES, across=0, width=RADIUS, fastest=0.0, place=("radius", "in the pipe"))


def measure(effort: Effort) -> Evidence:
    """The pipe on ever finer grids."""
    return FLOW.evidence({cells: FLOW.profiles(cells, VISCOSITY) for cells in CELLS[effort]})


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A viscosity that is 5 % too large."""
    return FLOW.measurements(FLOW.profiles(CELLS[Effort.QUICK][0], 1.05 * VISCOSITY))


CASE = Case(
    name="pipe_flow",
    title="Newtonian flow through a pipe (Hagen-Poiseuille), from rest",
    proves="shear around the axis: forces per radian, masses of points and the wall of a pipe",
    reference="u = rho g R^2/(4 eta) (1 - x^2 - sum 8 J0(l x)/(l^3 J1(l)) exp(-l^2 eta t/(rho R^2))), x = r/R, "
    "over the zeros l of J0",
    norm="largest error over the points, over the largest velocity",
    mistake="viscosity 5 % too large",
    measure=measure,
    control=control,
)
