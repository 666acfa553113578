"""The points of a file of another MPM code, whatever its format and whatever it calls them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import numpy as np

from grainlaw.materials import InputError
from grainlaw.validation.grains.readers.text_file import read_start
from grainlaw.validation.grains.snapshot import Array
from grainlaw.validation.mpm.readers import npz_file, ply_file, table_file, vtk_file
from grainlaw.validation.mpm.readers.names import AMOUNTS, COLUMNS, TIMES, UNLIKE, VECTORS
from grainlaw.validation.mpm.readers.point_table import PointTable

READERS: tuple[ModuleType, ...] = (npz_file, ply_file, vtk_file, table_file)
START = 4096
FORMATS = "npz, CSV, VTK (.vtk, .vtp, .vtu), PLY, or a table of t, x, h"
# Larger lengths than this [m] are taken for millimetres.
LARGEST_LENGTH = 100.0
# Names of a file that a message lists.
MOST_LISTED = 12


@dataclass(frozen=True)
class Points:
    """The points of one state.

    positions  shape (n, 2) or (n, 3) [m]
    amounts    mass, or volume, of each point in any unit, shape (n,); None where the file tells none: all are alike
    time       [s]; None where the file tells none
    """

    positions: Array
    amounts: Array | None
    time: float | None


def read_points(path: Path) -> Points:
    """The points of a file. Raises InputError in one line for whatever is wrong in it."""
    start = read_start(path, START)
    reader = next((reader for reader in READERS if reader.recognises(path, start)), None)
    if reader is None:
        raise InputError(f"{path} is in no known format: {FORMATS}")
    table: PointTable = reader.read_table(path)
    positions = _positions(table)
    return Points(positions, _amounts(table, len(positions)), _time(table))


def _positions(table: PointTable) -> Array:
    """Finite positions. Raises InputError where there are none, several, or others than of two or three components."""
    found = _vector(table)
    if found.ndim != 2 or found.shape[1] not in (2, 3):
        raise InputError(f"{table.path}: positions of the shape {found.shape}; expected (points, 2) or (points, 3)")
    if len(found) == 0:
        raise InputError(f"{table.path} holds no points")
    if lost := int((~np.isfinite(found)).any(axis=1).sum()):
        raise InputError(f"{table.path}: {lost} of {len(found)} points have positions that are no finite numbers")
    if (largest := float(np.abs(found).max())) > LARGEST_LENGTH:
        raise InputError(f"{table.path}: a position of {largest:g} m; is the file in millimetres?")
    return found


def _vector(table: PointTable) -> Array:
    if table.positions is not None:
        return table.positions
    vectors = [name for name, shape in table.shapes.items() if name.lower() in VECTORS and len(shape) > 1]
    single = {name.lower(): name for name, shape in table.shapes.items() if len(shape) == 1}
    columns = [[single[name] for name in names if name in single] for names in COLUMNS if {*names[:2]} <= single.keys()]
    choices = [*vectors, *(", ".join(names) for names in columns)]
    if not choices:
        there = ", ".join([*table.shapes][:MOST_LISTED]) or "nothing"
        raise InputError(
            f"{table.path} holds no positions: it has {there}; known are {', '.join(VECTORS)}, or columns x, y"
        )
    if len(choices) > 1:
        raise InputError(f"{table.path} holds positions more than once: {'; '.join(choices)}; leave one of them")
    if vectors:
        return table.load(vectors[0])
    loaded = [table.load(name) for name in columns[0]]
    if len({len(one) for one in loaded}) > 1:
        raise InputError(f"{table.path}: {', '.join(columns[0])} differ in length")
    return np.column_stack(loaded)


def _amounts(table: PointTable, count: int) -> Array | None:
    """What each point counts for, or None. Raises InputError where points differ and nothing says by how much."""
    for kind in AMOUNTS:
        names = [name for name in table.shapes if name.lower() in kind]
        if len(names) > 1:
            raise InputError(f"{table.path} holds {' and '.join(names)}; leave one of them")
        if names:
            return _amount(table, names[0], count)
    for name, shape in table.shapes.items():
        if name.lower() in UNLIKE and shape in ((count,), (count, 1)):
            values = table.load(name)
            if values.min() != values.max():
                raise InputError(
                    f"{table.path}: {name} goes from {values.min():g} to {values.max():g}, so that points are not all "
                    f"alike; a volume or a mass of each is needed"
                )
    return None


def _amount(table: PointTable, name: str, count: int) -> Array | None:
    values = np.ravel(table.load(name))
    if len(values) == 1 != count:
        return None
    if len(values) != count:
        raise InputError(f"{table.path}: {len(values)} values of {name} for {count} points")
    if not np.isfinite(values).all() or values.min() <= 0.0:
        raise InputError(f"{table.path}: values of {name} that are not above 0")
    return values


def _time(table: PointTable) -> float | None:
    """The time of the state. Raises InputError where a file holds several."""
    names: Sequence[str] = [name for name in table.shapes if name.lower() in TIMES]
    times = np.unique([np.ravel(table.load(name)) for name in names[:1]])
    if len(times) == 0:
        return None
    if len(times) > 1:
        raise InputError(f"{table.path}: {names[0]} from {times[0]:g} to {times[-1]:g} s; expected one state")
    return float(times[0]) if np.isfinite(times[0]) else None
