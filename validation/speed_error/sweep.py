"""Which settings are compared, and against what."""

from collections.abc import Iterator
from itertools import product

from validation.speed_error.setting import Setting

SAFETIES = (0.8, 0.4, 0.2)
SCHEMES = ("affine_flip", "apic")
BASES = ("linear", "quadratic", "cubic")
# On these all combinations are cheap; on the finer ones only one choice at a time departs from the defaults.
COARSE_CELLS = (0.05, 0.025)
FINE_CELL = 0.0125
REFERENCE_CELL = 0.00625


def settings(material: str, column: str = "paper") -> list[Setting]:
    """All settings for a material, cheap ones first; the last one is the reference."""
    found = [
        Setting(material, column, cell_size, safety, scheme, basis)
        for cell_size, safety, scheme, basis in product(COARSE_CELLS, SAFETIES, SCHEMES, BASES)
    ]
    return [*found, *_one_at_a_time(material, column, FINE_CELL), reference(material, column)]


def reference(material: str, column: str) -> Setting:
    """What errors are counted against: the defaults on the finest grid."""
    return Setting(material, column, REFERENCE_CELL)


def _one_at_a_time(material: str, column: str, cell_size: float) -> Iterator[Setting]:
    for safety in SAFETIES:
        yield Setting(material, column, cell_size, safety)
    yield Setting(material, column, cell_size, scheme="apic")
    yield Setting(material, column, cell_size, basis="linear")
    yield Setting(material, column, cell_size, basis="cubic")
    yield Setting(material, column, cell_size, precision="single")
