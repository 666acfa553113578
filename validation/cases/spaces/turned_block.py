"""A stressed block in three dimensions, turned about (1, 1, 1), and one whose axis of rotation turns as well."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.body import Body
from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Measurement, scaled_error
from grainlaw.validation.cases.exact.rigid_rotation import withhold_spin
from grainlaw.validation.scenes import block, simulation_of

Array = NDArray[np.float64]

BAND, LEAST_ORDER = 1e-9, 1.9
STEPS_OF_A_TURN = 64
CENTER = 0.5
COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "xz")
PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
START = 1e-6 * np.array([[-3.0, 0.5, -0.4], [0.5, -1.0, 0.7], [-0.4, 0.7, -2.0]])
DIAGONAL, UPWARDS = np.ones(3) / math.sqrt(3.0), np.array([0.0, 0.0, 1.0])
STEPS = {Effort.QUICK: (20, 40), Effort.FULL: (20, 40, 80, 160)}
# Inertia so large that the stress cannot bend the motion that the case prescribes.
SCENE: dict[str, Any] = {
    "space": "3d",
    "gravity": [0.0, 0.0, 0.0],
    "grid": {"cell_size": 0.1, "upper": [1.0, 1.0, 1.0]},
    "time": {"end": 1.0},
    "material": {"linear_elastic": {"bulk_modulus": 1e-6, "poisson_ratio": 0.3}},
    "body": [{"material": "linear_elastic", "shape": block([0.4] * 3, [0.6] * 3), "density": 1e6}],
}


def cross_matrix(vector: Array) -> Array:
    """The matrix K of a vector a, K b = a x b."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def rotation(axis: Array, angle: float) -> Array:
    """The rotation about an axis of unit length."""
    k = cross_matrix(axis)
    return np.asarray(np.eye(3) + math.sin(angle) * k + (1.0 - math.cos(angle)) * k @ k)


class Turning:
    """A rotation about (1, 1, 1) by an angle of 1 rad/s, whose axis turns about z `precession` times as fast."""

    def __init__(self, precession: float) -> None:
        self.precession = precession

    def rotation(self, time: float) -> Array:
        """R at a time [s]."""
        return rotation(UPWARDS, self.precession * time) @ rotation(DIAGONAL, time)

    def gradient(self, time: float) -> Array:
        """The velocity gradient, R' R^T [1/s]."""
        turned_axis = rotation(UPWARDS, self.precession * time) @ DIAGONAL
        return cross_matrix(self.precession * UPWARDS + turned_axis)


def stress_after(turning: Turning, end: float, steps: int, spinless: bool = False) -> Array:
    """The mean stress after a time [s] in equal steps, each with the gradient of its middle."""
    simulation = simulation_of(SCENE)
    body = simulation.bodies[0]
    start = body.positions - CENTER
    body.stress = np.array([[START[place]] for place in PLACES])
    if spinless:
        withhold_spin(body)
    step = end / steps
    for number in range(steps):
        _place(body, start, turning.rotation(number * step), turning.gradient((number + 0.5) * step))
        simulation.step(step)
    mean = np.empty((3, 3))
    for (i, j), value in zip(PLACES, body.stress.mean(axis=1), strict=True):
        mean[i, j] = mean[j, i] = value
    return mean


def _place(body: Body, start: Array, turned: Array, gradient: Array) -> None:
    """Put the points where the rotation has them, with its velocity and gradient."""
    place = turned @ start[:, body.ids]
    body.positions = CENTER + place
    body.velocity = gradient @ place
    body.velocity_gradient = body.affine = gradient[:, :, None]


def measurements(spinless: bool = False) -> tuple[Measurement, ...]:
    """Stress components after a whole turn about (1, 1, 1), and after an eighth, where no component is what it was."""
    found = []
    for turns, label in ((1.0, "one turn"), (0.125, "an eighth of a turn")):
        turning, end = Turning(precession=0.0), 2.0 * math.pi * turns
        measured = stress_after(turning, end, round(turns * STEPS_OF_A_TURN), spinless)
        exact = turning.rotation(end) @ START @ turning.rotation(end).T
        scale = float(np.linalg.norm(START))
        found += [
            scaled_error(f"sigma_{name} after {label}", "Pa", measured[place], exact[place], scale, BAND)
            for name, place in zip(COMPONENTS, PLACES, strict=True)
        ]
    return tuple(found)


def convergence(effort: Effort) -> Convergence:
    """Error of the stress after 1 s of a rotation whose axis turns, over the step."""
    turning, errors = Turning(precession=1.0), []
    exact = turning.rotation(1.0) @ START @ turning.rotation(1.0).T
    for steps in STEPS[effort]:
        errors.append(float(np.linalg.norm(stress_after(turning, 1.0, steps) - exact) / np.linalg.norm(START)))
    sizes = tuple(1.0 / steps for steps in STEPS[effort])
    return Convergence("stress, axis turning", "step [s]", sizes, tuple(errors), LEAST_ORDER)


def measure(effort: Effort) -> Evidence:
    """Steps of a 64th of a turn; with an axis that turns, of several sizes."""
    return Evidence(measurements(), (convergence(effort),))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The stress pass without spin."""
    return measurements(spinless=True)


CASE = Case(
    name="turned_block",
    title="stressed block turned about (1, 1, 1) in 3D",
    proves="the objective stress rate in 3D: exact about a fixed axis, of second order about a turning one",
    reference="sigma = R sigma_0 R^T with the exact rotation R; motion prescribed, gradient from the grid",
    norm="error of a component over |sigma_0|",
    mistake="stress pass without the spin of the material (no objective rate)",
    measure=measure,
    control=control,
)
