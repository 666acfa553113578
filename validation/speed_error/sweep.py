"""Which settings are compared, and against what."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

from mpm_core.accuracy import SHORT_MEMORY
from validation.speed_error.setting import Setting

SAFETIES = (0.8, 0.4, 0.2)
SCHEMES = ("affine_flip", "apic")
BASES = ("linear", "quadratic", "cubic")
POINTS_PER_CELL = (4, 9, 16)
# On these all combinations are cheap; on the finer ones only one choice at a time departs from the defaults.
COARSE_CELLS = (0.05, 0.025)
FINE_CELL = 0.0125
# A mean scatters less than one grid. Those of clay are coarser: finer ones cost more and come no closer to one another.
REFERENCE_CELLS = {
    "mu(I)-LC": (1.0 / 200.0, 1.0 / 220.0, 1.0 / 240.0),
    "MCC OCR 1": (1.0 / 180.0, 1.0 / 200.0, 1.0 / 220.0),
    "MCC OCR 4": (1.0 / 120.0, 1.0 / 140.0, 1.0 / 160.0),
}
# On these the transfer of the reference is compared too, where that is another than the default.
CELLS_OF_SHORT_MEMORY = {"mu(I)-LC": (*COARSE_CELLS, FINE_CELL, 1.0 / 120.0, 1.0 / 160.0, 1.0 / 200.0)}


def settings(material: str, column: str = "paper") -> list[Setting]:
    """All settings for a material, cheap ones first."""
    found = [
        Setting(material, column, *values)
        for values in product(COARSE_CELLS, POINTS_PER_CELL, SAFETIES, SCHEMES, BASES)
    ]
    short_memory = references(material, column, CELLS_OF_SHORT_MEMORY.get(material, ()))
    return [*found, *_one_at_a_time(material, column, FINE_CELL), *short_memory]


def references(material: str, column: str, cells: Sequence[float]) -> list[Setting]:
    """Grids with the most points and the transfer of the reference, against the mean of which errors are counted."""
    found = [Setting(material, column, cell_size) for cell_size in cells]
    if material not in CELLS_OF_SHORT_MEMORY:
        return found
    return [replace(setting, time_constant=SHORT_MEMORY * setting.cell_size) for setting in found]


def _one_at_a_time(material: str, column: str, cell_size: float) -> Iterator[Setting]:
    for points_per_cell in POINTS_PER_CELL:
        yield Setting(material, column, cell_size, points_per_cell)
    yield Setting(material, column, cell_size, safety=0.8)
    yield Setting(material, column, cell_size, safety=0.2)
    yield Setting(material, column, cell_size, scheme="apic")
    yield Setting(material, column, cell_size, basis="linear")
    yield Setting(material, column, cell_size, basis="cubic")
    yield Setting(material, column, cell_size, precision="single")
