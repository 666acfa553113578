"""Which settings are compared, and against what."""

from collections.abc import Iterator, Sequence
from itertools import product

from validation.speed_error.setting import Setting

SAFETIES = (0.8, 0.4, 0.2)
SCHEMES = ("affine_flip", "apic")
BASES = ("linear", "quadratic", "cubic")
POINTS_PER_CELL = (4, 9, 16)
# On these all combinations are cheap; on the finer ones only one choice at a time departs from the defaults.
COARSE_CELLS = (0.05, 0.025)
FINE_CELL = 0.0125
# The place of a shear band on the grid scatters a pile by one per cent however fine the grid is; a mean scatters less.
REFERENCE_CELLS = (1.0 / 120.0, 1.0 / 140.0, 1.0 / 160.0)


def settings(material: str, column: str = "paper") -> list[Setting]:
    """All settings for a material, cheap ones first."""
    found = [
        Setting(material, column, *values)
        for values in product(COARSE_CELLS, POINTS_PER_CELL, SAFETIES, SCHEMES, BASES)
    ]
    return [*found, *_one_at_a_time(material, column, FINE_CELL)]


def references(material: str, column: str, cells: Sequence[float] = REFERENCE_CELLS) -> list[Setting]:
    """The finest grids with the most points, against the mean of which errors are counted."""
    return [Setting(material, column, cell_size) for cell_size in cells]


def _one_at_a_time(material: str, column: str, cell_size: float) -> Iterator[Setting]:
    for points_per_cell in POINTS_PER_CELL:
        yield Setting(material, column, cell_size, points_per_cell)
    yield Setting(material, column, cell_size, safety=0.8)
    yield Setting(material, column, cell_size, safety=0.2)
    yield Setting(material, column, cell_size, scheme="apic")
    yield Setting(material, column, cell_size, basis="linear")
    yield Setting(material, column, cell_size, basis="cubic")
    yield Setting(material, column, cell_size, precision="single")
