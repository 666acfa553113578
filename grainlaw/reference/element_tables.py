"""The element tests and their settings."""

from grainlaw.materials.element.catalogue import ELEMENT_TESTS
from grainlaw.materials.element.mixed import MixedControl, mixed_test
from grainlaw.materials.element.settings import ElementTest
from grainlaw.reference.markdown import code, table


def element_test_reference() -> str:
    """Every element test with its settings."""
    mixed = mixed_test(MixedControl.model_construct())
    parts = []
    for test in (*ELEMENT_TESTS.values(), mixed):
        parts += [f"### {test.name}\n", f"{test.summary[0].upper()}{test.summary[1:]}.\n", _setting_table(test)]
    return "\n".join(parts)


def _setting_table(test: ElementTest) -> str:
    defaults = test.settings._field_defaults
    rows = [
        [code(name), found.unit, code(found.bounds), f"{defaults[name]:g}", found.doc]
        for name, found in test.setting_declarations.items()
    ]
    return table(["setting", "unit", "allowed", "default", "meaning"], rows)
