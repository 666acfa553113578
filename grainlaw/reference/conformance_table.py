"""The checks of `grainlaw check`, from the suite and the box themselves."""

from grainlaw.materials.conformance.suite import CHECKS
from grainlaw.reference.markdown import code, table
from grainlaw.validation.box import BOX


def conformance_table() -> str:
    """Every check and what it proves."""
    return table(["check", "what it proves"], [[code(check.name), check.proves] for check in (*CHECKS, BOX)])
