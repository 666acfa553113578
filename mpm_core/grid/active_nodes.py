"""The active nodes, those that points awake can touch until they are sorted again: a range of each column of nodes.

Work on the grid follows these nodes, so that its cost does not depend on the domain, nor on the air above a pile. All
other nodes hold zeros.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.kernels.shape_functions import Basis, first_node
from grainlaw.mpm_core.kernels.sources import CORE_MARK

# Cells by which a point may drift between two sorts, rounded up (`sorting.LONGEST_DRIFT`).
DRIFT = 1


class ActiveColumns(NamedTuple):
    """The active nodes column by column, as passes over the grid take them; all limits are inclusive.

    first_column, last_column  of the columns of nodes that have any; without any, the last lies before the first
    first_rows, last_rows      in each column of the grid, along the last axis
    """

    first_column: int
    last_column: int
    first_rows: NDArray[np.int64]
    last_rows: NDArray[np.int64]


class ActiveNodes(NamedTuple):
    """The active nodes, all limits inclusive; where there are none, the last lies before the first.

    first, last  along each axis, of the nodes that are active for any numbers along the others
    columns      column by column
    """

    first: tuple[int, ...]
    last: tuple[int, ...]
    columns: ActiveColumns

    @property
    def nodes(self) -> int:
        """Number of active nodes."""
        return int(np.maximum(0, self.columns.last_rows - self.columns.first_rows + 1).sum())


def no_active_nodes(grid: Grid) -> ActiveNodes:
    """The active nodes of no points."""
    return active_between(grid, *_nothing(grid))


def _nothing(grid: Grid) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    return np.full(grid.columns, grid.shape[-1]), np.full(grid.columns, -1)


def active_between(grid: Grid, first_rows: NDArray[np.int64], last_rows: NDArray[np.int64]) -> ActiveNodes:
    """The active nodes with these first and last rows in each column of the grid."""
    occupied = np.flatnonzero(last_rows >= first_rows)
    along = np.unravel_index(occupied if len(occupied) > 0 else [0], grid.shape[:-1])
    if len(occupied) == 0:
        nowhere = (0,) * grid.space.axes, (-1,) * grid.space.axes
        return ActiveNodes(*nowhere, ActiveColumns(0, -1, first_rows, last_rows))
    first = *(int(numbers.min()) for numbers in along), int(first_rows.min())
    last = *(int(numbers.max()) for numbers in along), int(last_rows.max())
    columns = ActiveColumns(int(occupied[0]), int(occupied[-1]), first_rows, last_rows)
    return ActiveNodes(first, last, columns)


def find_active_nodes(
    groups: Sequence[NDArray[np.float64]], grid: Grid, basis: Basis, periodic_axes: Sequence[int]
) -> ActiveNodes:
    """The nodes that groups of points can touch until they have drifted; all of them along a periodic axis.

    A group is an array of points like `Body.points`.
    """
    first, last = _nothing(grid)
    for points in groups:
        _first_nodes(points[: grid.space.axes], grid.origin, grid.cell_size, basis.offset, grid.shape, first, last)
    is_occupied = last >= 0
    first[is_occupied] -= DRIFT
    last[is_occupied] += basis.width - 1 + DRIFT
    columns = grid.shape[:-1]
    first, last = first.reshape(columns), last.reshape(columns)
    for axis in range(len(columns)):
        first, last = _spread(first, axis, basis.width, np.minimum), _spread(last, axis, basis.width, np.maximum)
        if axis in periodic_axes:
            first[:] = first.min(axis=axis, keepdims=True)
            last[:] = last.max(axis=axis, keepdims=True)
    first, last = np.clip(first.ravel(), 0, grid.shape[-1]), np.clip(last.ravel(), -1, grid.shape[-1] - 1)
    if grid.space.up in periodic_axes:
        is_occupied = last >= first
        first[is_occupied], last[is_occupied] = 0, grid.shape[-1] - 1
    return active_between(grid, first, last)


def _spread(rows: NDArray[np.int64], axis: int, width: int, extreme: np.ufunc) -> NDArray[np.int64]:
    """The extreme of the columns whose stencils, with the drift, reach a column along an axis."""
    spread = rows.copy()
    source, target = np.moveaxis(rows, axis, 0), np.moveaxis(spread, axis, 0)
    for way in range(-DRIFT, width + DRIFT):
        if way > 0:
            extreme(target[way:], source[:-way], out=target[way:])
        elif way < 0:
            extreme(target[:way], source[-way:], out=target[:way])
    return spread


@njit(cache=True)
@named(CORE_MARK)
def _first_nodes(places, origin, cell_size, offset, shape, lowest, highest):  # type: ignore[no-untyped-def]
    """Lower and raise the first node of the stencils in each column to those of the points."""
    up = len(origin) - 1
    for p in range(places.shape[1]):
        column = 0
        for axis in range(up):
            column = column * shape[axis] + first_node(places[axis, p], origin[axis], cell_size, offset)
        row = first_node(places[up, p], origin[up], cell_size, offset)
        lowest[column], highest[column] = min(lowest[column], row), max(highest[column], row)
