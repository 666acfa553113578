"""The conformance suite: every check on every parameter set of a law."""

from collections.abc import Iterator, Sequence

from grainlaw.materials import Law
from grainlaw.materials.conformance import code, declared, energy, finished, mechanics
from grainlaw.materials.conformance.outcome import Check, Outcome
from grainlaw.materials.conformance.subject import Subject

CHECKS = (
    Check(
        "declarations",
        "every quantity states its unit, meaning and bounds, the header its equations",
        declared.declarations,
    ),
    Check(
        "finished",
        "`update` uses every parameter that is declared; what the file says is to be written is listed",
        finished.finished,
    ),
    Check("units", "in other units of length, mass and time the answers are the same", declared.units),
    Check(
        "bounds",
        "parameters at and between their bounds give numbers and carry load, or are refused as inconsistent",
        declared.bounds,
    ),
    Check("equilibrium", "without strain, an initial state stays as it is", mechanics.equilibrium),
    Check(
        "objectivity",
        "rotated stress and strain rate give the rotated stress and the same state",
        mechanics.objectivity,
    ),
    Check("tension", "the pressure is never negative, unless `carries_tension` is declared", mechanics.tension),
    Check(
        "dissipation",
        "along closed paths of strain a point gives no more energy than it held at the start",
        mechanics.dissipation,
    ),
    Check(
        "stored energy",
        "the elastic energy that a law states comes back, and leaves no negative dissipation; skipped without",
        energy.stored_energy,
    ),
    Check(
        "convergence",
        "the stress at the end of a path converges with the step, with order 0.7 or better",
        mechanics.convergence,
    ),
    Check(
        "sound speed",
        "rho c^2 is no more than 1 % below the stiffness against small waves, in the step of a run",
        mechanics.sound_speed,
    ),
    Check(
        "viscosity",
        "a declared `viscosity` is no more than 1 % below the one against small waves; the step that it allows",
        mechanics.viscosity,
    ),
    Check("finite", "stress, state and wave speed are numbers at p = 0, opened and closed again", code.finite),
    Check("pure", "the same input gives the same output, however often and in whatever order", code.pure),
    Check("compiled", "compiled code gives the bits of plain Python", code.compiled),
    Check("single", "a law that says `holds_in_single` gives the same stress in single precision", code.single),
    Check("ptx", "the update compiles for a GPU; skipped without numba-cuda", code.ptx),
    Check("cost", "nanoseconds of one compiled update in shear flow; a report, not a limit", code.cost),
)
QUICK, FULL = 1, 4


def examine(law: Law, effort: int, checks: Sequence[Check] = CHECKS) -> Iterator[tuple[Check, Outcome]]:
    """Each check with its outcome on the law: the first failure among its parameter sets, or the last outcome."""
    subjects = [Subject(law, name, effort) for name in law.parameter_sets]
    for check in checks:
        yield check, _outcome(check, subjects)


def _outcome(check: Check, subjects: list[Subject]) -> Outcome:
    outcome = Outcome("FAIL", "the law has no named parameter set to be tried with")
    for subject in subjects:
        try:
            outcome = check.measure(subject)
        except Exception as error:  # whatever a law raises is a finding about it
            outcome = Outcome("FAIL", f"{type(error).__name__}: {error}")
        if outcome.verdict == "FAIL":
            where = f"set '{subject.set_name}': " if len(subjects) > 1 else ""
            return Outcome("FAIL", where + outcome.reason)
    return outcome
