"""The active nodes, those that points awake can touch until they are sorted again: a range of rows per column of nodes.

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
from grainlaw.mpm_core.layout import X, Y

# Cells by which a point may drift between two sorts, rounded up (`sorting.LONGEST_DRIFT`).
DRIFT = 1


class ActiveNodes(NamedTuple):
    """The active nodes, all limits inclusive; where there are none, the last lies before the first.

    first_column, last_column  of the columns of nodes that have any
    first_row, last_row        of the rows that have any
    first_rows, last_rows      in each column of the grid
    """

    first_column: int
    last_column: int
    first_row: int
    last_row: int
    first_rows: NDArray[np.int64]
    last_rows: NDArray[np.int64]

    @property
    def nodes(self) -> int:
        """Number of active nodes."""
        return int(np.maximum(0, self.last_rows - self.first_rows + 1).sum())

    def along(self, axis: int) -> tuple[int, int]:
        """First and last of the nodes along x (0) or y (1)."""
        return (self.first_column, self.last_column) if axis == 0 else (self.first_row, self.last_row)


def no_active_nodes(grid: Grid) -> ActiveNodes:
    """The active nodes of no points."""
    return active_between(np.full(grid.shape[0], grid.shape[1]), np.full(grid.shape[0], -1))


def active_between(first_rows: NDArray[np.int64], last_rows: NDArray[np.int64]) -> ActiveNodes:
    """The active nodes with these first and last rows in each column of the grid."""
    columns = np.flatnonzero(last_rows >= first_rows)
    first, last = (int(columns[0]), int(columns[-1])) if len(columns) > 0 else (0, -1)
    return ActiveNodes(first, last, int(first_rows.min()), int(last_rows.max()), first_rows, last_rows)


def find_active_nodes(
    groups: Sequence[NDArray[np.float64]], grid: Grid, basis: Basis, periodic_axes: Sequence[int]
) -> ActiveNodes:
    """The nodes that groups of points can touch until they have drifted; all of them along a periodic axis.

    A group is an array of points like `Body.points`.
    """
    *_, first, last = no_active_nodes(grid)
    for points in groups:
        _extend(points[X], points[Y], grid.origin, grid.cell_size, basis.offset, basis.width, first, last)
    np.clip(first, 0, grid.shape[1], out=first)
    np.clip(last, -1, grid.shape[1] - 1, out=last)
    if 0 in periodic_axes:
        first[:], last[:] = first.min(), last.max()
    if 1 in periodic_axes:
        occupied = last >= first
        first[occupied], last[occupied] = 0, grid.shape[1] - 1
    return active_between(first, last)


@njit(cache=True)
@named(CORE_MARK)
def _extend(x, y, origin, cell_size, offset, width, first_rows, last_rows):  # type: ignore[no-untyped-def]
    columns = len(first_rows)
    lowest, highest = np.full(columns, np.int64(2**31)), np.full(columns, np.int64(-1))
    for p in range(len(x)):
        i, j = first_node(x[p], y[p], origin, cell_size, offset)
        lowest[i], highest[i] = min(lowest[i], j), max(highest[i], j)
    for i in range(columns):
        if highest[i] >= 0:
            for column in range(max(0, i - DRIFT), min(columns, i + width + DRIFT)):
                first_rows[column] = min(first_rows[column], lowest[i] - DRIFT)
                last_rows[column] = max(last_rows[column], highest[i] + width - 1 + DRIFT)
