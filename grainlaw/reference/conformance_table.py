"""The checks of `grainlaw check`, from the suite itself."""

from grainlaw.materials.conformance.suite import CHECKS
from grainlaw.reference.markdown import code, table


def conformance_table() -> str:
    """Every check and what it proves."""
    return table(["check", "what it proves"], [[code(check.name), check.proves] for check in CHECKS])
