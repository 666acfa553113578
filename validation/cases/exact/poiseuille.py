"""Newtonian flow between two plates: start-up from rest and the parabola that it comes to."""

import math
from typing import Any

import numpy as np

from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.scenes import advance, simulation_of

BAND = 2e-2
HEIGHT, DENSITY, VISCOSITY, BULK_MODULUS, PRESSURE = 1.0, 1000.0, 100.0, 1e5, 1e4
ACCELERATION = 0.01
CELLS = {Effort.QUICK: (20,), Effort.FULL: (10, 20, 40)}
# The slowest mode decays over rho H^2/(pi^2 eta) = 1.01 s.
TIMES = {"start": 0.3, "steady": 6.0}
LEAST_ORDER = 1.8
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


def profiles(cells: int, viscosity: float = VISCOSITY) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Heights [m] and velocities [m/s] of the points at each of the times."""
    simulation = simulation_of(scene(cells, viscosity))
    body, found = simulation.bodies[0], {}
    for name, time in TIMES.items():
        advance(simulation, time)
        found[name] = body.positions[1].copy(), body.velocity[0].copy()
    return found


def error(name: str, profile: tuple[np.ndarray, np.ndarray]) -> float:
    """Largest error of the points' velocity over the largest velocity at that time."""
    y, v = profile
    largest = float(exact_velocity(0.5 * HEIGHT, TIMES[name]))
    return float(np.abs(v - exact_velocity(y, TIMES[name])).max()) / largest


def measurements(found: dict[str, tuple[np.ndarray, np.ndarray]]) -> tuple[Measurement, ...]:
    """The profile at both times."""
    return tuple(
        upper_bound(f"t = {TIMES[name]:g} s: largest error of the profile", "1", error(name, profile), BAND)
        for name, profile in found.items()
    )


def measure(effort: Effort) -> Evidence:
    """The layer on ever finer grids."""
    results = {cells: profiles(cells) for cells in CELLS[effort]}
    finest = results[CELLS[effort][-1]]
    z = np.linspace(0.0, HEIGHT, 60)
    curves = []
    for name, (y, v) in finest.items():
        order = np.argsort(y)[:: max(1, len(y) // 40)]
        curves.append(curve(f"exact, {TIMES[name]:g} s", exact_velocity(z, TIMES[name]), z, "reference"))
        curves.append(curve(f"measured, {TIMES[name]:g} s", v[order], y[order]))
    figure = Figure("Velocity between the plates", "velocity [m/s]", "height [m]", tuple(curves))
    convergence = tuple(
        Convergence(
            f"profile at {TIMES[name]:g} s",
            "cell size",
            tuple(HEIGHT / cells for cells in results),
            tuple(error(name, found[name]) for found in results.values()),
            LEAST_ORDER,
        )
        for name in TIMES
        if len(results) > 1
    )
    return Evidence(measurements(finest), convergence, (figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The convention s = eta D_d, in which eta counts half of the velocity gradient."""
    return measurements(profiles(CELLS[Effort.QUICK][0], 0.5 * VISCOSITY))


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
