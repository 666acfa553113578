"""Checks of what a law does: rest, rotation, tension, energy, step size and the speed of its waves."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import SymmetricTensor, half_norm, isotropic, pressure
from grainlaw.materials.conformance.outcome import Outcome, judged
from grainlaw.materials.conformance.subject import DT, PointState, Subject, largest_difference

Array = NDArray[np.float64]

EXACT = 1e-8
COMPONENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
NO_STRAIN = isotropic(0.0)
SHEAR_AMPLITUDE = 0.02
# Of the trapezoidal rule, in the work of a path and in the energy that unloading returns.
WORK_ERROR, STORED_ERROR = 1e-3, 0.05
PROBE_STRAIN = 1e-6
# The step of the probe is the one of a run at this safety on cells of this size [m], those of the paper's collapse.
SAFETY, CELL_SIZE = 0.4, 0.00625
# Of the stiffness and of the viscosity; the probe's own strain stiffens Cam Clay by 1e-4. The floor keeps traces of
# pressure out of the quotient.
ALLOWED_EXCESS = 0.01
FLOOR = 1e-3
# Of the rate of strain, and at rest [1/s].
PROBE_SHARE, PROBE_RATE = 1e-3, 1e-7
SHORTEST_STEP = 1e-15
LEAST_ORDER = 0.7


def equilibrium(subject: Subject) -> Outcome:
    """A point at rest keeps the stress and the state that it was given."""
    worst = 0.0
    for share in (0.1, 1.0, 10.0):
        start = point = subject.at_rest(share * subject.pressure)
        for _ in range(20):
            point = subject.moved(point, NO_STRAIN)
        worst = max(
            worst,
            largest_difference(start.stress, point.stress, share * subject.pressure),
            largest_difference(tuple(start.state), tuple(point.state), 0.0),
        )
    return judged(worst <= EXACT, f"stress and state move by {worst:.0e} in 20 steps without strain")


def objectivity(subject: Subject) -> Outcome:
    """Rotated stress and strain rate give the rotated stress and the same state."""
    random = np.random.default_rng(0)
    law, worst = subject.law, 0.0
    for call in subject.calls:
        rotation, _ = np.linalg.qr(random.standard_normal((3, 3)))
        start, strain_rate, expected = (
            _tensor(rotation @ _matrix(found) @ rotation.T)
            for found in (call.start.stress, call.strain_rate, call.end.stress)
        )
        stress, state = law.update(start, strain_rate, call.end.density, call.start.state, subject.parameters, call.dt)
        worst = max(
            worst,
            largest_difference(stress, expected, subject.pressure),
            largest_difference(tuple(state), tuple(call.end.state), EXACT),
        )
    return judged(worst <= EXACT, f"rotated input gives rotated output to {worst:.0e}")


def tension(subject: Subject) -> Outcome:
    """Grains that are pulled apart carry no tension, unless the law declares that its material does."""
    lowest = min(pressure(call.end.stress) for call in subject.calls)
    for direction in (isotropic(1.0), SymmetricTensor(0.0, 1.0, 0.0, 0.0, 0.0, 0.0)):
        point = subject.at_rest(subject.pressure)
        for _ in range(100):
            point = subject.moved(point, 1e-3 / DT * direction)
            lowest = min(lowest, pressure(point.stress))
    if subject.law.carries_tension:
        return Outcome("pass", f"declared: carries tension (found: {max(0.0, -lowest):.3g} Pa)")
    if lowest >= -EXACT * subject.pressure:
        return Outcome("pass", "the pressure is never negative")
    return Outcome("FAIL", f"carries a tension of {-lowest:.3g} Pa, which it does not declare")


def dissipation(subject: Subject) -> Outcome:
    """Along closed paths of strain a point never gives more energy than it held at the start.

    The energy that it held is what unloading it isotropically returns. This is the second law for a law whose free
    energy is not known: the work that has been done on the point, plus that energy, cannot become negative.
    """
    start = subject.at_rest(subject.pressure)
    stored = recovered_work(subject, start)
    random = np.random.default_rng(0)
    most_given = 0.0
    for path in range(3 * subject.effort):
        done, turned_over = 0.0, 0.0
        increments = closed_path(random, subject.elastic_strain, loops=3)
        for _, work in subject.work(start, increments, DT * 10.0 ** (-(path % 3))):
            done += work
            turned_over += abs(work)
            most_given = max(most_given, -done - WORK_ERROR * turned_over)
    if most_given <= (1.0 + STORED_ERROR) * stored:
        return Outcome("pass", f"gives back {most_given:.3g} J/m3 at most, of {stored:.3g} stored at the start")
    return Outcome(
        "FAIL", f"gives {most_given:.3g} J/m3 along closed paths of strain, but holds {stored:.3g} at the start"
    )


def convergence(subject: Subject) -> Outcome:
    """Along one path the stress converges as the step shrinks."""
    direction = np.array([0.3, -1.0, 0.2, 0.6, -0.4, 0.3]) * SHEAR_AMPLITUDE
    direction[:3] -= (direction[:3].sum() + subject.elastic_strain) / 3.0
    counts = (25, 50, 100, 200, 400)
    finest = _stress_after(subject, direction, 4 * counts[-1])
    size = max(abs(value) for value in finest)
    errors = [largest_difference(_stress_after(subject, direction, count), finest, size) for count in counts]
    if errors[-1] <= EXACT:
        return Outcome("pass", f"no dependence on the step ({errors[-1]:.0e})")
    order = math.log2(max(errors[0], 1e-300) / errors[-1]) / math.log2(counts[-1] / counts[0])
    return judged(order >= LEAST_ORDER, f"order {order:.2f}, error {errors[-1]:.0e} with {counts[-1]} steps")


def sound_speed(subject: Subject) -> Outcome:
    """Rho c^2 is never below the stiffness that a small strain measures, in any state along the paths.

    The strain comes within one step; of a law that declares a viscosity, the stress is read a step later, at the rate
    of before.
    """
    random = np.random.default_rng(0)
    start = subject.at_rest(subject.pressure)
    floor = FLOOR * subject.stiffness(start)
    dt = _step_of_a_run(subject)
    worst = 0.0
    for state, rate in _states_in_motion(subject):
        stiffness = subject.stiffness(state)
        if not (math.isfinite(stiffness) and stiffness >= 0.0):
            return Outcome(
                "FAIL", f"the speed of sound is {math.sqrt(stiffness / state.density) if stiffness > 0 else stiffness}"
            )
        response = _tangent(_after_strain(subject, state, rate, dt), PROBE_STRAIN, random)
        worst = max(worst, response / (stiffness + floor))
    if worst <= 1.0 + ALLOWED_EXCESS:
        return Outcome("pass", f"measured stiffness up to {worst:.4g} of rho c^2")
    return Outcome("FAIL", f"the measured stiffness is {worst:.4g} times rho c^2: a run would take too large a step")


def viscosity(subject: Subject) -> Outcome:
    """The declared viscosity is never below the one that a small change of the rate measures, and what it asks for."""
    declared = subject.law.viscosity
    if declared is None:
        return Outcome("pass", "none declared: `sound speed` holds in the step of a run")
    random = np.random.default_rng(0)
    floor = FLOOR * subject.stiffness(subject.at_rest(subject.pressure)) * _step_of_a_run(subject)
    worst, limit = 0.0, math.inf
    for state, rate in _states_in_motion(subject):
        stated = declared(state.stress, rate, state.density, state.state, subject.parameters)
        probe = PROBE_SHARE * half_norm(rate) or PROBE_RATE
        worst = max(worst, _tangent(_after_rate(subject, state, rate), probe, random) / (stated + floor))
        if stated > 0.0:
            limit = min(limit, 0.5 * state.density * CELL_SIZE**2 / stated)
    if not worst <= 1.0 + ALLOWED_EXCESS:
        return Outcome("FAIL", f"the measured viscosity is {worst:.4g} times the one declared")
    steps = (
        f"explicit steps up to {limit:.1e} s on cells of {CELL_SIZE:g} m, of {_step_of_a_run(subject):.1e} s for waves"
    )
    return Outcome("pass", f"measured up to {worst:.4g} of the declared one: {steps}")


def _matrix(found: SymmetricTensor) -> Array:
    xx, yy, zz, xy, yz, xz = found
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _tensor(matrix: Array) -> SymmetricTensor:
    return SymmetricTensor(*(float(matrix[index]) for index in COMPONENTS))


def recovered_work(subject: Subject, start: PointState) -> float:
    """The work that isotropic unloading returns until the pressure is gone [J/m3]."""
    increment = 0.02 * subject.elastic_strain / 3.0
    increments = np.tile([increment, increment, increment, 0.0, 0.0, 0.0], (2000, 1))
    returned = 0.0
    for point, work in subject.work(start, increments, DT):
        if not pressure(point.stress) > 0.0:
            break
        returned -= work
    return returned


def closed_path(random: np.random.Generator, elastic_strain: float, loops: int) -> Array:
    """Strain increments, shape (steps, 6), along polygons that begin and end without strain."""
    corners = [np.zeros(6)]
    for _ in range(loops):
        for _ in range(3):
            strain = random.standard_normal(6) * SHEAR_AMPLITUDE
            strain[:3] += (random.uniform(-1.5, 1.0) * elastic_strain - strain[:3].sum()) / 3.0
            corners.append(strain)
        corners.append(np.zeros(6))
    return np.repeat(np.diff(corners, axis=0) / 40.0, 40, axis=0)


def _stress_after(subject: Subject, strain: Array, steps: int) -> SymmetricTensor:
    rate, point = SymmetricTensor(*strain.tolist()), subject.at_rest(subject.pressure)
    for _ in range(steps):
        point = subject.moved(point, rate, 1.0 / steps)
    return point.stress


def _compressed(subject: Subject, share: float) -> PointState:
    """After isotropic compression by a share of the elastic strain."""
    point = subject.at_rest(subject.pressure)
    for _ in range(50):
        point = subject.moved(point, isotropic(-share * subject.elastic_strain / 150.0 / DT))
    return point


def _step_of_a_run(subject: Subject) -> float:
    return SAFETY * CELL_SIZE / subject.law.sound_speed(*subject.at_rest(subject.pressure), subject.parameters)


def _states_in_motion(subject: Subject) -> list[tuple[PointState, SymmetricTensor]]:
    """States at rest, compressed and along the paths, with the rate of strain [1/s] that led there."""
    states = [subject.at_rest(share * subject.pressure) for share in (0.1, 1.0, 10.0)]
    states += [_compressed(subject, share) for share in (-0.5, 2.0, 20.0)]
    return [(state, NO_STRAIN) for state in states] + [(call.end, call.strain_rate) for call in subject.calls[::10]]


def _after_strain(
    subject: Subject, state: PointState, rate: SymmetricTensor, dt: float
) -> Callable[[SymmetricTensor], SymmetricTensor]:
    """The stress as a function of a small strain within a step."""

    def stress(strain: SymmetricTensor) -> SymmetricTensor:
        point = subject.moved(state, strain / dt, dt)
        return point.stress if subject.law.viscosity is None else subject.moved(point, rate, dt).stress

    return stress


def _after_rate(
    subject: Subject, state: PointState, rate: SymmetricTensor
) -> Callable[[SymmetricTensor], SymmetricTensor]:
    """The stress as a function of a small change of the rate, in a step too short for any strain."""

    def stress(change: SymmetricTensor) -> SymmetricTensor:
        return subject.moved(state, rate + change, SHORTEST_STEP).stress

    return stress


def _tangent(stress: Callable[[SymmetricTensor], SymmetricTensor], size: float, random: np.random.Generator) -> float:
    """The largest derivative of a stress against small plane waves, longitudinal and transverse, of either sign."""
    still = _matrix(stress(NO_STRAIN))
    largest = 0.0
    frame, _ = np.linalg.qr(random.standard_normal((3, 3)))
    for axes in (np.eye(3), frame):
        for normal in range(3):
            for along in (normal, (normal + 1) % 3):
                for signed in (-size, size):
                    gradient = signed * np.outer(axes[normal], axes[along])
                    change = _matrix(stress(_tensor(0.5 * (gradient + gradient.T)))) - still
                    largest = max(largest, float(axes[normal] @ change @ axes[along]) / signed)
    return largest
