"""Periodic sides: nodes that are one and the same."""

from numba import njit

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.grid import COMPONENTS, Grid
from grainlaw.mpm_core.kernels.sources import CORE_MARK


def join_periodic(grid: Grid, axis: int) -> None:
    """Add up the nodes that are one and the same across a periodic axis, and give all copies the sum."""
    across, along = grid.strides[axis], grid.strides[1 - axis]
    _join(grid.nodes, across, along, grid.shape[axis], grid.shape[1 - axis], grid.cells[axis])


@njit(cache=True)
@named(CORE_MARK)
def _join(nodes, across, along, rows, count, period):  # type: ignore[no-untyped-def]
    for low in range(rows - period):
        for k in range(count):
            a = low * across + k * along
            b = a + period * across
            for c in range(COMPONENTS):
                total = nodes[a + c] + nodes[b + c]
                nodes[a + c] = total
                nodes[b + c] = total
