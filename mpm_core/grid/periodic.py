"""Periodic sides: nodes that are one and the same."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.grid import COMPONENTS, Grid
from grainlaw.mpm_core.kernels.sources import CORE_MARK


def join_periodic(grid: Grid, axis: int) -> None:
    """Add up the nodes that are one and the same across a periodic axis, and give all copies the sum."""
    across, along = grid.strides[axis], grid.strides[1 - axis]
    _join(grid.nodes, across, along, grid.shape[axis], grid.shape[1 - axis], grid.cells[axis])


def join_marks(marks: NDArray[np.bool_], axis: int, period: int) -> None:
    """Mark all copies of nodes of which one is marked; the marks may reach further beyond the sides than the nodes."""
    along = np.moveaxis(marks, axis, 0)
    for low in range(min(period, len(along) - period)):
        copies = along[low::period]
        copies[:] = copies.any(axis=0)


@njit(cache=True)
@named(CORE_MARK)
def _join(nodes, across, along, rows, count, period):  # type: ignore[no-untyped-def]
    # Over few cells there are three copies of a node.
    for low in range(min(period, rows - period)):
        for k in range(count):
            first = low * across + k * along
            for c in range(COMPONENTS):
                total = nodes[first + c]
                for copy in range(low + period, rows, period):
                    total += nodes[copy * across + k * along + c]
                for copy in range(low, rows, period):
                    nodes[copy * across + k * along + c] = total
