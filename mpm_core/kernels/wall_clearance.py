"""The clearance between a friction wall and the material that comes down on it.

A friction wall is unilateral. Contact begins when the edge of the material is at the wall, not when the shape function
of the wall row first reaches a point, up to a cell and a half before. The clearance of a node on the wall is that of
the nearest material in its support,

    g_i = min over the points p with w_i(x_p) > 0 of max(0, d_p - s_p/2),   s_p = sqrt(min(V_p, V_0)),

with the distance d_p of a point from the wall and its size s_p, the side of a square of its volume, in three
dimensions of a cube: a point of a full cell of 2 x 2 points that touches a wall is a quarter of a cell away. An opened
point is no larger than at the start: what it gained is void. A point that is closer than half of its size touches, no
more. The node may approach the wall by no more than g_i in a step (`walls`).

A minimum does not depend on the order of points, nor on which thread looks at which of them. Which points can come near
a wall before the next sort is found again from where they are, so that a checkpoint need not hold any of it.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import Any

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.active_nodes import DRIFT
from grainlaw.mpm_core.grid.cell_volumes import WallGap
from grainlaw.mpm_core.grid.grid import GHOSTS, Grid
from grainlaw.mpm_core.kernels.point_size import make_size_of
from grainlaw.mpm_core.kernels.positions import coordinate_of, position_access
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.walls import WallKind, axes_along
from grainlaw.mpm_core.space import Space

# Distances below this, in cells, are round-off of places and volumes: what starts on a wall touches it.
ROUND_OFF = 1e-9
# Clearances beyond this, in cells, are gaps.
SMALLEST_GAP = 0.05


class WallClearance:
    """The points that may come into the support of the layers of friction walls before the next sort.

    `layers` are those of walls (`walls.HELD_LAYER`). Threads share the points: each finds the clearances to its own.
    """

    def __init__(
        self,
        layers: NDArray[np.void],
        bodies: Sequence[Body],
        grid: Grid,
        basis: Basis,
        periodic_axes: Sequence[int],
        threads: int,
    ) -> None:
        self.layers = layers
        self.bodies = bodies
        self.grid = grid
        self.basis = basis
        self.periodic_axes = periodic_axes
        self.near = [self._near(body) for body in bodies]
        largest = max(math.prod(grid.shape) // nodes for nodes in grid.shape)
        self._clearances_of_threads = np.empty((threads, len(layers), largest))
        self._joined = list(self._across_periodic_axes())

    def _near(self, body: Body) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Numbers of the points of a body near each layer, one layer after another, and where those of each begin."""
        nothing = np.empty(0, np.int64)
        found = [
            self._near_layer(body, layer) if layer["kind"] == WallKind.FRICTION else nothing for layer in self.layers
        ]
        return np.concatenate([nothing, *found]), np.cumsum([0, *map(len, found)])

    def _near_layer(self, body: Body, layer: np.void) -> NDArray[np.int64]:
        away = np.abs(coordinate_of(body.points, layer["axis"], body.space) - layer["position"])
        return np.flatnonzero(away < (0.5 * self.basis.width + DRIFT) * self.grid.cell_size)

    def clearances(self) -> NDArray[np.float64]:
        """The clearance [m] of each node of each layer.

        It is infinite where no point is in the support of the node, or no clearance is asked for. One array for all
        steps, shape (layers, nodes of the largest layer of the grid).
        """
        of_threads, grid, basis = self._clearances_of_threads, self.grid, self.basis
        of_threads.fill(math.inf)
        for body, (near, starts) in zip(self.bodies, self.near, strict=True):
            if len(near) > 0:
                narrow = _make_narrow(body.space, body.precision)
                points = body.storage, body.point_mass, body.initial_density
                on_grid = grid.origin, grid.cell_size, grid.shape, basis.offset, basis.width
                narrow(near, starts, self.layers, *points, *on_grid, of_threads)
        for clearances, cells in self._joined:
            self._join(clearances, cells)
        of_all: NDArray[np.float64] = of_threads[0]
        return of_all

    def _across_periodic_axes(self) -> Iterator[tuple[NDArray[np.float64], int]]:
        """Clearances of layers along periodic axes, those first, and the cells of each such axis."""
        for clearances, layer in zip(self._clearances_of_threads[0], self.layers, strict=True):
            along = axes_along(int(layer["axis"]), self.grid.space.axes)
            for place, axis in enumerate(along):
                if axis in self.periodic_axes:
                    yield np.moveaxis(self._of_layer(clearances, along), place, 0), self.grid.cells[axis]

    def _of_layer(self, clearances: NDArray[np.float64], along: tuple[int, ...]) -> NDArray[np.float64]:
        """Clearances of a layer, as many axes as there are along it."""
        shape = [self.grid.shape[axis] for axis in along]
        return clearances[: math.prod(shape)].reshape(shape)

    def gaps(self) -> list[WallGap]:
        """Where friction walls, the ones that let material leave, are not touched by it."""
        found = []
        for layer, clearances in zip(self.layers, self.clearances(), strict=True):
            if layer["kind"] == WallKind.FRICTION:
                along = axes_along(int(layer["axis"]), self.grid.space.axes)
                on_grid = tuple(slice(GHOSTS, GHOSTS + self.grid.cells[axis] + 1) for axis in along)
                off = self._of_layer(clearances, along)[on_grid] > SMALLEST_GAP * self.grid.cell_size
                for axis in range(len(along)):
                    ends = np.moveaxis(off, axis, 0)
                    off = np.moveaxis(ends[:-1] & ends[1:], 0, axis)
                found.append(WallGap(int(layer["axis"]), bool(layer["sign"] > 0.0), off))
        return found

    def _join(self, clearances: NDArray[np.float64], cells: int) -> None:
        """Give nodes that are one and the same across a periodic axis, the first, the least of their clearances."""
        nodes = len(clearances)
        for low in range(min(cells, nodes - cells)):
            copies = clearances[low:nodes:cells]
            copies[:] = copies.min(axis=0)


@cache
def _make_narrow(space: Space, precision: str) -> Callable[..., Any]:
    """A kernel that narrows clearances along layers to those of points in a precision; the first thread's hold all."""
    access, in_3d, mark = position_access(space, precision), space.axes == 3, f"{space.name}_{precision}_{CORE_MARK}"
    along, size_of = access.along, make_size_of(space, precision)

    @register_jitable
    @named(mark)
    def first_node_along(storage, axis, p, origin, inverse_size, offset, last):  # type: ignore[no-untyped-def]
        return min(int((along(storage, axis, p) - origin[axis]) * inverse_size - offset), last)

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(mark)
    def narrow(  # type: ignore[no-untyped-def]
        near, starts, layers, storage, mass, least_density, origin, cell_size, shape, offset, width, of_threads
    ):
        threads, inverse_size = len(of_threads), 1.0 / cell_size
        farthest, nothing = 0.5 * width * cell_size, ROUND_OFF * cell_size
        for thread in prange(threads):
            for number in range(len(layers)):
                axis, position, nodes = layers[number].axis, layers[number].position, of_threads[thread, number]
                one, other = (1 if axis == 0 else 0), (1 if axis == 2 else 2)
                start, count = starts[number], starts[number + 1] - starts[number]
                for p in near[start + count * thread // threads : start + count * (thread + 1) // threads]:
                    distance = abs(along(storage, axis, p) - position)
                    if distance < farthest:
                        clearance = distance - 0.5 * size_of(storage, p, mass, least_density)
                        clearance = clearance if clearance > nothing else 0.0
                        first = first_node_along(storage, one, p, origin, inverse_size, offset, shape[one] - width)
                        second, end, breadth = 0, 1, 1
                        if in_3d:
                            breadth = shape[other]
                            second = first_node_along(storage, other, p, origin, inverse_size, offset, breadth - width)
                            end = second + width
                        for a in range(first, first + width):
                            lowered = nodes[a * breadth + second : a * breadth + end]
                            np.minimum(lowered, clearance, lowered)
        for thread in range(1, threads):
            np.minimum(of_threads[0], of_threads[thread], of_threads[0])

    return narrow
