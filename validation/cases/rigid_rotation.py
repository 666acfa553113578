"""A stressed block led through ten rigid turns: its stress turns with it and does not change otherwise."""

import math
from typing import Any

import numpy as np

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.layout import AFFINE, GRADIENT, LXY, LYX, SXX, SXY, SYY, SZZ, VX, VY, X, Y
from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Measurement, scaled_error
from grainlaw.validation.scenes import simulation_of

BAND = 1e-3
TURNS = 10
# A multiple of eight, for the last eighth of a turn.
STEPS_OF_A_TURN = 632
CENTER = 0.5
START = {SXX: -3.0, SYY: -1.0, SZZ: -2.0, SXY: 0.5}
# Inertia so large that the stress of 1 Pa cannot bend the motion that the case prescribes.
SCENE: dict[str, Any] = {
    "gravity": [0.0, 0.0],
    "grid": {"cell_size": 0.05, "upper": [1.0, 1.0]},
    "time": {"end": 1.0},
    "material": {"linear_elastic": {"bulk_modulus": 1.0, "poisson_ratio": 0.3}},
    "body": [
        {
            "material": "linear_elastic",
            "shape": {"kind": "rectangle", "lower": [0.3, 0.3], "upper": [0.7, 0.7]},
            "density": 1e12,
        }
    ],
}


def turned_stress(angle: float) -> dict[int, float]:
    """The start stress after a rigid rotation, by components."""
    cosine, sine = math.cos(angle), math.sin(angle)
    rotation = np.array([[cosine, -sine], [sine, cosine]])
    plane = rotation @ np.array([[START[SXX], START[SXY]], [START[SXY], START[SYY]]]) @ rotation.T
    return {SXX: plane[0, 0], SYY: plane[1, 1], SZZ: START[SZZ], SXY: plane[0, 1]}


def place(body: Body, start: np.ndarray, angle: float) -> None:
    """Put the points where a rigid rotation of 1 rad/s has them at an angle, with its velocity and gradient."""
    x, y = start[:, body.ids] - CENTER
    cosine, sine = math.cos(angle), math.sin(angle)
    turned_x, turned_y = cosine * x - sine * y, sine * x + cosine * y
    body.points[X], body.points[Y] = CENTER + turned_x, CENTER + turned_y
    body.points[VX], body.points[VY] = -turned_y, turned_x
    body.points[GRADIENT] = body.points[AFFINE] = np.array([[0.0], [-1.0], [1.0], [0.0]])


def stress_after(steps_of_a_turn: int, turns: float, withhold_spin: bool = False) -> dict[int, float]:
    """The mean stress after rotation in equal steps, by components."""
    simulation = simulation_of(SCENE)
    body = simulation.bodies[0]
    start = body.points[[X, Y]].copy()
    for component, value in START.items():
        body.points[component] = value
    if withhold_spin:
        _withhold_spin(body)
    step = 2.0 * math.pi / steps_of_a_turn
    for count in range(round(turns * steps_of_a_turn)):
        place(body, start, count * step)
        simulation.step(step)
    return {component: float(body.points[component].mean()) for component in START}


def _withhold_spin(body: Body) -> None:
    """Show the stress pass the symmetric part of the velocity gradient only."""
    update = body.update_stress

    def without_spin(dt: float, tied: float = 0.0, exchange: float = 0.0, threads: int = 1) -> None:
        gradient = body.points[[LXY, LYX]]
        body.points[[LXY, LYX]] = gradient.mean(axis=0)
        update(dt, tied, exchange, threads)
        body.points[[LXY, LYX]] = gradient

    body.update_stress = without_spin  # type: ignore[method-assign]


def measurements(withhold_spin: bool = False) -> tuple[Measurement, ...]:
    """Stress components after ten turns and an eighth, where no component is what it was."""
    turns = TURNS + 0.125
    measured = stress_after(STEPS_OF_A_TURN, turns, withhold_spin)
    exact = turned_stress(2.0 * math.pi * turns)
    scale = math.sqrt(sum(value * value for value in START.values()))
    names = {SXX: "sigma_xx", SYY: "sigma_yy", SZZ: "sigma_zz", SXY: "sigma_xy"}
    return tuple(scaled_error(names[c], "Pa", measured[c], exact[c], scale, BAND) for c in START)


def convergence(effort: Effort) -> Convergence:
    """Error of the stress after one turn, over the angle of a step; a step rotates exactly but for round-off."""
    counts = (80, 160) if effort is Effort.QUICK else (80, 160, 320, 640)
    errors = []
    for count in counts:
        measured = stress_after(count, 1.0)
        exact = turned_stress(0.0)
        errors.append(math.hypot(measured[SXX] - exact[SXX], measured[SXY] - exact[SXY]))
    sizes = tuple(2.0 * math.pi / count for count in counts)
    return Convergence("stress after one turn", "angle of a step [rad]", sizes, tuple(errors))


def measure(effort: Effort) -> Evidence:
    """Steps of 0.01 rad, an order of magnitude longer than those of a collapse."""
    return Evidence(measurements(), (convergence(effort),))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The stress pass without spin."""
    return measurements(withhold_spin=True)


CASE = Case(
    name="rigid_rotation",
    title="stressed block, ten rigid turns",
    proves="the objective stress rate: rotation leaves a stress alone but for turning it",
    reference="sigma = R sigma_0 R^T with the exact rotation R; motion prescribed, gradient from the grid",
    norm="error of a component over |sigma_0|",
    mistake="stress pass without the spin of the material (no objective rate)",
    measure=measure,
    control=control,
)
