"""The background grid: one flat array of nodes, of which only those around the material are ever touched."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials.precision import PRECISIONS
from grainlaw.mpm_core.kernels.simd.registers import LANES
from grainlaw.mpm_core.layout import CACHE_LINE

# Components of a node, two quads, in double precision a cache line. The first quad: momentum and force before the
# momentum update, new and old velocity after it. The second: mass, volume and volume times pressure before, mass and
# what `volume_coupling` takes after.
PX, PY, FX, FY = 0, 1, 2, 3
NEW_VX, NEW_VY, OLD_VX, OLD_VY = 0, 1, 2, 3
BULK = LANES
MASS, VOLUME, VOLUME_PRESSURE = BULK, BULK + 1, BULK + 2
NODE_PRESSURE, NODE_DENSITY = BULK + 1, BULK + 2
COMPONENTS = 2 * LANES

# Nodes beyond each side of the domain, enough for the widest stencil of a point that touches a wall.
GHOSTS = 2
# Ghosts that no stencil reaches, for axes without walls.
NO_GHOSTS = (-1, 2**31 - 1)


class Grid:
    """A rectangle of `cells` square cells of `cell_size` [m] whose lower corner is `lower` [m].

    `precision` is one of `PRECISIONS`.
    Memory is reserved for the whole domain but, being zero until written, occupied only where material has been.
    """

    def __init__(
        self,
        lower: tuple[float, float],
        cells: tuple[int, int],
        cell_size: float,
        periodic_axes: Sequence[int] = (),
        precision: str = "double",
    ) -> None:
        self.lower = lower
        self.cells = cells
        self.cell_size = cell_size
        self.upper = (lower[0] + cells[0] * cell_size, lower[1] + cells[1] * cell_size)
        self.shape = (cells[0] + 1 + 2 * GHOSTS, cells[1] + 1 + 2 * GHOSTS)
        self.precision = precision
        self.nodes = self.empty_nodes()
        # The nodes just beyond the walls, whose velocity is tied to the inside; no node where the axis is periodic.
        walls = [NO_GHOSTS if axis in periodic_axes else self._ghosts(axis) for axis in (0, 1)]
        self.ghosts = (*walls[0], *walls[1])
        self.origin = (lower[0] - GHOSTS * cell_size, lower[1] - GHOSTS * cell_size)

    def empty_nodes(self) -> NDArray[Any]:
        """Another set of nodes like `nodes`, all zero."""
        return _aligned_zeros(self.shape[0] * self.shape[1] * COMPONENTS, PRECISIONS[self.precision])

    @property
    def strides(self) -> tuple[int, int]:
        """Distance in `nodes` between neighbours along x and along y."""
        return self.shape[1] * COMPONENTS, COMPONENTS

    def _ghosts(self, axis: int) -> tuple[int, int]:
        return GHOSTS - 1, GHOSTS + self.cells[axis] + 1


def _aligned_zeros(count: int, number: type[np.floating[Any]]) -> NDArray[Any]:
    """Zeroed numbers from the start of a cache line on, of which a node fills one, or half; no memory is touched."""
    line = CACHE_LINE // np.dtype(number).itemsize
    try:
        buffer = np.zeros(count + line, number)
    except ValueError as error:
        # More than an array may hold, which is more than there is of memory.
        raise MemoryError(f"{count} numbers") from error
    start = (-buffer.ctypes.data % CACHE_LINE) // buffer.itemsize
    return buffer[start : start + count]
