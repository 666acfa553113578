"""A stressed block led through ten rigid turns: its stress turns with it and does not change otherwise."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.body import Body
from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Measurement, scaled_error
from grainlaw.validation.scenes import simulation_of

Stress = NDArray[np.float64]

BAND = 1e-3
TURNS = 10
# A multiple of eight, for the last eighth of a turn.
STEPS_OF_A_TURN = 632
CENTER = 0.5
COMPONENTS = ("xx", "yy", "zz", "xy")
START = 1e-6 * np.array([-3.0, -1.0, -2.0, 0.5])
# Inertia so large that the stress cannot bend the motion that the case prescribes.
SCENE: dict[str, Any] = {
    "gravity": [0.0, 0.0],
    "grid": {"cell_size": 0.05, "upper": [1.0, 1.0]},
    "time": {"end": 1.0},
    "material": {"linear_elastic": {"bulk_modulus": 1e-6, "poisson_ratio": 0.3}},
    "body": [
        {
            "material": "linear_elastic",
            "shape": {"kind": "rectangle", "lower": [0.3, 0.3], "upper": [0.7, 0.7]},
            "density": 1e6,
        }
    ],
}


def turned_stress(angle: float) -> Stress:
    """The start stress after a rigid rotation, as `COMPONENTS`."""
    cosine, sine = math.cos(angle), math.sin(angle)
    rotation = np.array([[cosine, -sine], [sine, cosine]])
    xx, yy, zz, xy = START
    plane = rotation @ np.array([[xx, xy], [xy, yy]]) @ rotation.T
    return np.array([plane[0, 0], plane[1, 1], zz, plane[0, 1]])


def place(body: Body, start: np.ndarray, angle: float) -> None:
    """Put the points where a rigid rotation of 1 rad/s has them at an angle, with its velocity and gradient."""
    x, y = start[:, body.ids] - CENTER
    cosine, sine = math.cos(angle), math.sin(angle)
    turned_x, turned_y = cosine * x - sine * y, sine * x + cosine * y
    body.positions = CENTER + np.array([turned_x, turned_y])
    body.velocity = np.array([-turned_y, turned_x])
    body.velocity_gradient = body.affine = np.array([[[0.0], [-1.0]], [[1.0], [0.0]]])


def stress_after(steps_of_a_turn: int, turns: float, spinless: bool = False) -> Stress:
    """The mean stress after rotation in equal steps, as `COMPONENTS`."""
    simulation = simulation_of(SCENE)
    body = simulation.bodies[0]
    start = body.positions.copy()
    body.stress = START[:, None]
    if spinless:
        withhold_spin(body)
    step = 2.0 * math.pi / steps_of_a_turn
    for count in range(round(turns * steps_of_a_turn)):
        place(body, start, count * step)
        simulation.step(step)
    mean: Stress = body.stress.mean(axis=1)
    return mean


def withhold_spin(body: Body) -> None:
    """Show the stress pass the symmetric part of the velocity gradient only."""
    update = body.update_stress

    def without_spin(dt: float, coupled_time: float = 0.0, threads: int = 1) -> None:
        gradient = body.velocity_gradient.copy()
        body.velocity_gradient = 0.5 * (gradient + gradient.swapaxes(0, 1))
        update(dt, coupled_time, threads)
        body.velocity_gradient = gradient

    body.update_stress = without_spin  # type: ignore[method-assign]


def measurements(spinless: bool = False) -> tuple[Measurement, ...]:
    """Stress components after ten turns and an eighth, where no component is what it was."""
    turns = TURNS + 0.125
    measured = stress_after(STEPS_OF_A_TURN, turns, spinless)
    exact = turned_stress(2.0 * math.pi * turns)
    scale = float(np.linalg.norm(START))
    found = zip(COMPONENTS, measured.tolist(), exact.tolist(), strict=True)
    return tuple(scaled_error(f"sigma_{name}", "Pa", now, wanted, scale, BAND) for name, now, wanted in found)


def convergence(effort: Effort) -> Convergence:
    """Error of the stress after one turn, over the angle of a step; a step rotates exactly but for round-off."""
    counts = (80, 160) if effort is Effort.QUICK else (80, 160, 320, 640)
    errors = []
    for count in counts:
        measured = stress_after(count, 1.0)
        exact = turned_stress(0.0)
        errors.append(float(np.linalg.norm((measured - exact)[[0, 3]])))
    sizes = tuple(2.0 * math.pi / count for count in counts)
    return Convergence("stress after one turn", "angle of a step [rad]", sizes, tuple(errors))


def measure(effort: Effort) -> Evidence:
    """Steps of 0.01 rad, an order of magnitude longer than those of a collapse."""
    return Evidence(measurements(), (convergence(effort),))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The stress pass without spin."""
    return measurements(spinless=True)


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
