"""Periodic sides: nodes that are one and the same."""

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.kernels.sources import CORE_MARK


def join_periodic(grid: Grid, numbers: NDArray[Any], axis: int) -> None:
    """Add up the nodes that are one and the same across a periodic axis, and give all copies the sum.

    `numbers` are `Grid.nodes` or `Grid.bulk`.
    """
    layers = numbers.reshape(math.prod(grid.shape[:axis]), grid.shape[axis], -1)
    _join(layers, grid.cells[axis])


def join_marks(marks: NDArray[np.bool_], axis: int, period: int) -> None:
    """Mark all copies of nodes of which one is marked; the marks may reach further beyond the sides than the nodes."""
    along = np.moveaxis(marks, axis, 0)
    for low in range(min(period, len(along) - period)):
        copies = along[low::period]
        copies[:] = copies.any(axis=0)


@njit(cache=True)
@named(CORE_MARK)
def _join(layers, period):  # type: ignore[no-untyped-def]
    # Over few cells there are three copies of a node, or more.
    for outer in range(layers.shape[0]):
        for low in range(min(period, layers.shape[1] - period)):
            for c in range(layers.shape[2]):
                total = layers[outer, low, c]
                for copy in range(low + period, layers.shape[1], period):
                    total += layers[outer, copy, c]
                for copy in range(low, layers.shape[1], period):
                    layers[outer, copy, c] = total
