"""What every reader of points returns: arrays by name, loaded when they are asked for."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from grainlaw.materials import InputError
from grainlaw.validation.grains.snapshot import Array

# More would not fit into memory once they are spread over cells.
MOST_POINTS = 20_000_000


@dataclass(frozen=True)
class PointTable:
    """The arrays of a file.

    shapes     of all arrays that hold numbers, by name; () of a single number
    load       the array of a name. Raises InputError in one line where it is damaged
    positions  shape (n, 3), where the format itself has a place for them
    """

    path: Path
    shapes: Mapping[str, tuple[int, ...]]
    load: Callable[[str], Array]
    positions: Array | None = None


def table_of_arrays(path: Path, arrays: Mapping[str, Array], positions: Array | None = None) -> PointTable:
    """The table of a file that has been read whole."""
    return PointTable(path, {name: np.shape(values) for name, values in arrays.items()}, arrays.__getitem__, positions)


def refuse_too_many(path: Path, count: int) -> None:
    """Raises InputError for more points than can be spread over cells."""
    if count > MOST_POINTS:
        raise InputError(f"{path}: {count} points; allowed are up to {MOST_POINTS}")
