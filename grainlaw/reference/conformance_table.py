"""The checks of `grainlaw check`, from the suite itself."""

from grainlaw.reference.markdown import code, table
from validation.conformance.suite import CHECKS


def conformance_table() -> str:
    """Every check and what it proves."""
    return table(["check", "what it proves"], [[code(check.name), check.proves] for check in CHECKS])
