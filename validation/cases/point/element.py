"""Element tests for validation cases."""

from collections.abc import Mapping
from pathlib import Path

from grainlaw.materials.element.catalogue import get_element_test
from grainlaw.materials.element.result import ElementResult
from grainlaw.materials.element.run import run_element_test
from grainlaw.materials.element.specimen import prepared


def element_history(
    test_name: str, law: str, parameters: str | Path | None = None, assignments: Mapping[str, float] | None = None
) -> ElementResult:
    """The history of an element test; assignments are values of the law or settings of the test, by name."""
    test = get_element_test(test_name)
    return run_element_test(test, *prepared(law, parameters, assignments or {}, test))
