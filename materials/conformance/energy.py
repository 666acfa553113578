"""Checks of the elastic energy that a law states: against what a point gives back, and against what it dissipates."""

import numpy as np

from grainlaw.materials import SymmetricTensor, deviator, pressure
from grainlaw.materials.conformance.mechanics import EXACT, STORED_ERROR, WORK_ERROR, closed_path, recovered_work
from grainlaw.materials.conformance.outcome import Outcome
from grainlaw.materials.conformance.subject import DT, PointState, Subject

# Of the energy that isotropic unloading returns, and of the work of a small reversible shear.
UNLOADING_ERROR, SHEAR_ERROR = 1e-2, 1e-2
# Shear of the probe over the elastic strain, small enough to be reversible where anything is, and its steps.
PROBE_SHEAR, PROBE_STEPS = 0.05, 20
REVERSIBLE = 1e-3


def stored_energy(subject: Subject) -> Outcome:
    """The stated elastic energy is what comes back from a point, and never leaves a negative dissipation."""
    if subject.law.stored_energy is None:
        return Outcome("skipped", "the law does not state its elastic energy")
    start = subject.at_rest(subject.pressure)
    lowest = min(_energy(subject, call.end) for call in subject.calls)
    if not lowest >= 0.0:
        return Outcome("FAIL", f"an energy of {lowest:.3g} J/kg: it must not be negative")
    stored, returned = start.density * _energy(subject, start), recovered_work(subject, start)
    if not start.density * _energy(subject, subject.at_rest(0.0)) <= EXACT * stored:
        return Outcome("FAIL", "energy without stress")
    if not abs(returned - stored) <= UNLOADING_ERROR * stored:
        return Outcome("FAIL", f"isotropic unloading returns {returned:.4g} J/m3, the law states {stored:.4g}")
    shear = _error_of_reversible_shear(subject)
    if not shear <= SHEAR_ERROR:
        return Outcome("FAIL", f"the energy of a small reversible shear is wrong by {shear:.2g} of the work")
    least = _least_dissipation(subject, start)
    reason = f"unloading returns {returned / stored:.4f} of it, dissipation at least {least:.1e} of the energy held"
    return Outcome("pass" if least >= -STORED_ERROR else "FAIL", reason)


def _energy(subject: Subject, point: PointState) -> float:
    assert subject.law.stored_energy is not None
    return subject.law.stored_energy(*point, subject.parameters)


def _error_of_reversible_shear(subject: Subject) -> float:
    """Work less energy over work, the largest of shears that come back without loss from a half unloaded point."""
    start = subject.at_rest(subject.pressure)
    unloading = np.tile([0.5 * subject.elastic_strain / 300.0] * 3 + [0.0] * 3, (100, 1))
    for point, _ in subject.work(start, unloading, DT):
        start = point
    if not pressure(start.stress) > 0.0:
        return 0.0
    random, worst = np.random.default_rng(0), 0.0
    for _ in range(3 * subject.effort):
        direction = deviator(SymmetricTensor(*random.standard_normal(6).tolist()))
        step = np.array(direction) / np.linalg.norm(direction) * PROBE_SHEAR * subject.elastic_strain / PROBE_STEPS
        there = list(subject.work(start, np.tile(step, (PROBE_STEPS, 1)), DT))
        turn, out = there[-1][0], sum(work for _, work in there)
        back = sum(work for _, work in subject.work(turn, np.tile(-step, (PROBE_STEPS, 1)), DT))
        back *= start.density / turn.density
        if out > 0.0 and abs(out + back) <= REVERSIBLE * out:
            gained = start.density * (_energy(subject, turn) - _energy(subject, start))
            worst = max(worst, abs(out - gained) / out)
    return worst


def _least_dissipation(subject: Subject, start: PointState) -> float:
    """Work less energy along closed paths of strain, over the largest energy held on the path; at most 0."""
    random, least = np.random.default_rng(0), 0.0
    at_start = _energy(subject, start)
    for path in range(3 * subject.effort):
        done, turned_over, held, lowest = 0.0, 0.0, at_start, 0.0
        increments = closed_path(random, subject.elastic_strain, loops=3)
        for point, work in subject.work(start, increments, DT * 10.0 ** (-(path % 3))):
            done += work
            turned_over += abs(work)
            energy = _energy(subject, point)
            held = max(held, energy)
            lowest = min(lowest, done - start.density * (energy - at_start) + WORK_ERROR * turned_over)
        least = min(least, lowest / (start.density * held))
    return least
