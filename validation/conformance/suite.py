"""The conformance suite: every check on every parameter set of a law."""

from collections.abc import Iterator

from materials import Law
from validation.conformance import code, declared, mechanics
from validation.conformance.outcome import Check, Outcome
from validation.conformance.subject import Subject

CHECKS = (
    Check("declarations", "every quantity has unit and meaning, the header its equations", declared.declarations),
    Check("units", "the equations agree with the declared units", declared.units),
    Check("bounds", "all parameters within bounds work", declared.bounds),
    Check("equilibrium", "the initial state is at rest", mechanics.equilibrium),
    Check("objectivity", "rotated input, rotated output", mechanics.objectivity),
    Check("tension", "no tension, or declared", mechanics.tension),
    Check("dissipation", "closed paths give no energy", mechanics.dissipation),
    Check("convergence", "smaller steps, smaller error", mechanics.convergence),
    Check("sound speed", "never below the measured stiffness", mechanics.sound_speed),
    Check("finite", "numbers at p = 0, opened and closed", code.finite),
    Check("pure", "same input, same output", code.pure),
    Check("compiled", "plain Python and compiled code agree", code.compiled),
    Check("ptx", "compiles for a GPU", code.ptx),
    Check("cost", "time of one update", code.cost),
)
QUICK, FULL = 1, 4


def examine(law: Law, effort: int) -> Iterator[tuple[Check, Outcome]]:
    """Each check with its outcome on the law: the first failure among its parameter sets, or the last outcome."""
    subjects = [Subject(law, name, effort) for name in law.parameter_sets]
    for check in CHECKS:
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
