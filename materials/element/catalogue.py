"""The element tests by name."""

from grainlaw.materials.element.compression import COMPRESSION_TESTS
from grainlaw.materials.element.settings import ElementTest
from grainlaw.materials.element.shear import SHEAR_TESTS
from grainlaw.materials.errors import InputError, nearest_name

ELEMENT_TESTS: dict[str, ElementTest] = {test.name: test for test in (*SHEAR_TESTS, *COMPRESSION_TESTS)}

# Mixed control is described by a file and has a driver of its own.
MIXED = "mixed"
TEST_NAMES = (*ELEMENT_TESTS, MIXED)


def get_element_test(name: str) -> ElementTest:
    """The element test of that name. Raises InputError with the nearest valid name."""
    if name not in ELEMENT_TESTS:
        raise InputError(f"unknown element test '{name}'; {nearest_name(name, TEST_NAMES)}")
    return ELEMENT_TESTS[name]
