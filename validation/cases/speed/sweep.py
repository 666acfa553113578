"""Which settings are compared, and against what."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from grainlaw.validation.cases.speed.setting import Setting

SAFETIES = (0.8, 0.4, 0.2)
SCHEMES = ("affine_flip", "apic")
BASES = ("linear", "quadratic", "cubic")
POINTS_PER_CELL = (4, 9, 16)
# On these all combinations are cheap; on the finer ones only one choice at a time departs from the defaults.
COARSE_CELLS = (0.05, 0.025)
FINE_CELL = 0.0125


@dataclass(frozen=True)
class Reference:
    """Grids against the mean of which errors are counted, as it scatters less than one of them.

    cells            cell sizes [m]
    points_per_cell  material points per cell
    """

    cells: tuple[float, ...]
    points_per_cell: int = 16


REFERENCES = {
    "mu(I)-LC": Reference((1.0 / 200.0, 1.0 / 220.0, 1.0 / 240.0)),
    "MCC OCR 1": Reference((1.0 / 180.0, 1.0 / 200.0, 1.0 / 220.0)),
    "MCC OCR 4": Reference((1.0 / 160.0, 1.0 / 180.0, 1.0 / 200.0), 25),
}
# On these points of the reference are compared too, where they are others than the defaults.
CELLS_LIKE_REFERENCE = {"mu(I)-LC": (*COARSE_CELLS, FINE_CELL, 1.0 / 120.0, 1.0 / 160.0, 1.0 / 200.0)}


def settings(material: str, column: str = "paper") -> list[Setting]:
    """All settings for a material, cheap ones first."""
    found = [
        Setting(material, column, *values)
        for values in product(COARSE_CELLS, POINTS_PER_CELL, SAFETIES, SCHEMES, BASES)
    ]
    like_reference = references(material, column, CELLS_LIKE_REFERENCE.get(material, ()))
    return [*found, *_one_at_a_time(material, column, FINE_CELL), *like_reference]


def references(material: str, column: str, cells: Sequence[float] | None = None) -> list[Setting]:
    """Grids with the points of the reference, of its own cell sizes if no others [m] are given."""
    chosen = REFERENCES[material]
    sizes = chosen.cells if cells is None else cells
    return [Setting(material, column, cell_size, chosen.points_per_cell) for cell_size in sizes]


def _one_at_a_time(material: str, column: str, cell_size: float) -> Iterator[Setting]:
    for points_per_cell in POINTS_PER_CELL:
        yield Setting(material, column, cell_size, points_per_cell)
    yield Setting(material, column, cell_size, safety=0.8)
    yield Setting(material, column, cell_size, safety=0.2)
    yield Setting(material, column, cell_size, scheme="apic")
    yield Setting(material, column, cell_size, basis="linear")
    yield Setting(material, column, cell_size, basis="cubic")
    yield Setting(material, column, cell_size, precision="single")
