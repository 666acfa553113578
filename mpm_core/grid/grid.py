"""The background grid: one flat array of nodes, of which only those around the material are ever touched.

Nodes are numbered along the last axis first. All nodes with the same numbers along the axes before it are a column of
nodes; columns are numbered in the same way. Work on the grid follows columns, and is the same in two and three axes.
"""

import math
import mmap
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials.precision import PRECISIONS
from grainlaw.mpm_core.kernels.simd.registers import LANES
from grainlaw.mpm_core.space import Space

# Numbers of a node, two quads, in double precision a cache line.
COMPONENTS = 2 * LANES


class NodeComponents(NamedTuple):
    """Which number of a node is which; of vectors the number of the first component.

    momentum  before the momentum update; after it the new velocity
    force     before the momentum update; after it the old velocity
    mass      of the node
    bulk      volume, and behind it volume times pressure, before the momentum update; after it mean pressure and mean
              density, which `volume_coupling` takes. In three dimensions they stand in an array of their own, as a
              node is full without them
    """

    momentum: int
    force: int
    mass: int
    bulk: int


# Two axes: momentum and force | mass, volume, volume times pressure. Three: momentum and mass | force.
NODE_OF = {2: NodeComponents(0, 2, LANES, LANES + 1), 3: NodeComponents(0, LANES, 3, 0)}
# Numbers of a node in the array of its own that bulk quantities have in three dimensions.
BULK_COMPONENTS = 2

# Nodes beyond each side of the domain, enough for the widest stencil of a point that touches a wall.
GHOSTS = 2
# Ghosts that no stencil reaches, for sides without a wall.
NO_GHOSTS = (-1, 2**31 - 1)


class CountedNodes(NamedTuple):
    """The nodes that sums over the grid count: of the copies of a node across a periodic axis one.

    columns                whether any of a column is counted
    first_row, row_behind  between which rows nodes are counted, along the last axis
    """

    columns: NDArray[np.bool_]
    first_row: int
    row_behind: int


class Grid:
    """A box of `cells` square or cubic cells of `cell_size` [m] whose lower corner is `lower` [m].

    `precision` is one of `PRECISIONS`. `open_sides` says along each axis whether the lower and the upper side are open;
    without it none is.
    Memory is reserved for the whole domain but, being zero until written, occupied only where material has been.
    """

    def __init__(
        self,
        space: Space,
        lower: Sequence[float],
        cells: Sequence[int],
        cell_size: float,
        periodic_axes: Sequence[int] = (),
        precision: str = "double",
        open_sides: Sequence[tuple[bool, bool]] = (),
    ) -> None:
        self.space = space
        self.lower = tuple(lower)
        self.cells = tuple(cells)
        self.cell_size = cell_size
        self.upper = tuple(low + count * cell_size for low, count in zip(lower, cells, strict=True))
        self.shape = tuple(count + 1 + 2 * GHOSTS for count in cells)
        # distance between neighbouring nodes along each axis, in nodes
        self.strides = tuple(math.prod(self.shape[axis + 1 :]) for axis in range(space.axes))
        self.precision = precision
        self.open_sides = tuple(open_sides) or ((False, False),) * space.axes
        self.counted = self._counted(periodic_axes)
        self.limits = tuple(self._limits(axis, periodic_axes) for axis in range(space.axes))
        self.components = NODE_OF[space.axes]
        self.nodes = self.empty_nodes()
        self.bulk = self.empty_bulk()
        # Of each axis the nodes just beyond its walls, whose velocity is tied to the inside; no node where a side is
        # periodic or open. All in one tuple: compiled passes take no tuples of tuples.
        self.ghosts = tuple(ghost for axis in range(space.axes) for ghost in self._ghosts(axis, periodic_axes))
        self.origin = tuple(low - GHOSTS * cell_size for low in self.lower)

    def empty_nodes(self) -> NDArray[Any]:
        """Another set of nodes like `nodes`, all zero."""
        return _aligned_zeros(math.prod(self.shape) * COMPONENTS, PRECISIONS[self.precision])

    def empty_bulk(self) -> NDArray[Any]:
        """Another set of numbers like `bulk`, all zero; none where nodes hold them."""
        nodes = math.prod(self.shape) if self.space.axes == 3 else 0
        return _aligned_zeros(nodes * BULK_COMPONENTS, PRECISIONS[self.precision])

    def _counted(self, periodic_axes: Sequence[int]) -> CountedNodes:
        between = [
            (GHOSTS, GHOSTS + count) if axis in periodic_axes else (0, nodes)
            for axis, (count, nodes) in enumerate(zip(self.cells, self.shape, strict=True))
        ]
        columns = np.zeros(self.shape[:-1], np.bool_)
        columns[tuple(slice(*limits) for limits in between[:-1])] = True
        return CountedNodes(columns.ravel(), *between[-1])

    def _limits(self, axis: int, periodic_axes: Sequence[int]) -> tuple[float, float]:
        """Between which coordinates along an axis points have to be [m]; infinite where they may leave."""
        below, above = (True, True) if axis in periodic_axes else self.open_sides[axis]
        return -math.inf if below else self.lower[axis], math.inf if above else self.upper[axis]

    def _ghosts(self, axis: int, periodic_axes: Sequence[int]) -> tuple[int, int]:
        walls = GHOSTS - 1, GHOSTS + self.cells[axis] + 1
        without = (True, True) if axis in periodic_axes else self.open_sides[axis]
        low, high = (NO_GHOSTS[end] if without[end] else walls[end] for end in (0, 1))
        return low, high

    @property
    def columns(self) -> int:
        """Number of columns of nodes."""
        return math.prod(self.shape[:-1])


def _aligned_zeros(count: int, number: type[np.floating[Any]]) -> NDArray[Any]:
    """Zeroed numbers in whole cache lines, of which a node fills one, or half; no memory is touched.

    Mapped as it is: NumPy asks for huge pages, of which every one along a pile's columns holds air for the most part.
    """
    try:
        # A mapping of no bytes is refused, and where bulk quantities are part of a node their own array has none.
        size = max(count * np.dtype(number).itemsize, 1)
        pages = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    except (OverflowError, ValueError, OSError) as error:
        # More than may be mapped, which is more than there is of memory.
        raise MemoryError(f"{count} numbers") from error
    return np.frombuffer(pages, number, count)
