"""The clearance between a friction wall and the material that comes down on it.

A friction wall is unilateral. Contact begins when the edge of the material is at the wall, not when the shape function
of the wall row first reaches a point, up to a cell and a half before. The clearance of a node on the wall is that of
the nearest material in its support,

    g_i = min over the points p with w_i(x_p) > 0 of max(0, d_p - s_p/2),   s_p = sqrt(min(V_p, V_0)),

with the distance d_p of a point from the wall and its size s_p, the side of a square of its volume: a point of a full
cell of 2 x 2 points that touches a wall is a quarter of a cell away. An opened point is no larger than at the start:
what it gained is void. A point that is closer than half of its size touches, no more. The node may approach the wall by
no more than g_i in a step (`boundary`).

A minimum does not depend on the order of points, nor on which thread looks at which of them. Which points can come near
a wall before the next sort is found again from where they are, so that a checkpoint need not hold any of it.
"""

import math
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.active_nodes import DRIFT
from grainlaw.mpm_core.grid.cell_volumes import WallGap
from grainlaw.mpm_core.grid.grid import GHOSTS, Grid
from grainlaw.mpm_core.kernels.positions import coordinate_of, position_access
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.walls import WallKind

# Distances below this, in cells, are round-off of places and volumes: what starts on a wall touches it.
ROUND_OFF = 1e-9
# Clearances beyond this, in cells, are gaps.
SMALLEST_GAP = 0.05


class WallClearance:
    """The points that may come into the support of the rows of friction walls before the next sort.

    `rows` are those of walls (`boundary.HELD_ROW`). Threads share the points: each finds the clearances to its own.
    """

    def __init__(
        self,
        rows: NDArray[np.void],
        bodies: Sequence[Body],
        grid: Grid,
        basis: Basis,
        periodic_axes: Sequence[int],
        threads: int,
    ) -> None:
        self.rows = rows
        self.bodies = bodies
        self.grid = grid
        self.basis = basis
        self.joined = [int(row) for row in np.flatnonzero(np.isin(1 - rows["axis"], periodic_axes))]
        self.near = [self._near(body) for body in bodies]
        self._clearances_of_threads = np.empty((threads, len(rows), max(grid.shape)))

    def _near(self, body: Body) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Numbers of the points of a body that are near each row, row after row, and where those of each row begin."""
        nothing = np.empty(0, np.int64)
        found = [self._near_row(body, row) if row["kind"] == WallKind.FRICTION else nothing for row in self.rows]
        return np.concatenate([nothing, *found]), np.cumsum([0, *map(len, found)])

    def _near_row(self, body: Body, row: np.void) -> NDArray[np.int64]:
        away = np.abs(coordinate_of(body.points, row["axis"]) - row["position"])
        return np.flatnonzero(away < (0.5 * self.basis.width + DRIFT) * self.grid.cell_size)

    def clearances(self) -> NDArray[np.float64]:
        """The clearance [m] of each node along each row.

        It is infinite where no point is in the support of the node, or no clearance is asked for. One array for all
        steps, shape (rows, nodes along the longer side of the grid).
        """
        of_threads, grid, basis = self._clearances_of_threads, self.grid, self.basis
        of_threads.fill(math.inf)
        for body, (near, starts) in zip(self.bodies, self.near, strict=True):
            if len(near) > 0:
                narrow = _make_narrow(body.precision)
                points = body.storage, body.point_mass, body.initial_density
                on_grid = grid.origin, grid.cell_size, basis.offset, basis.width
                narrow(near, starts, self.rows, *points, *on_grid, of_threads)
        clearances: NDArray[np.float64] = of_threads[0]
        for number in self.joined:
            self._join(clearances[number], 1 - int(self.rows[number]["axis"]))
        return clearances

    def gaps(self) -> list[WallGap]:
        """Where friction walls, the ones that let material leave, are not touched by it."""
        found = []
        for row, clearances in zip(self.rows, self.clearances(), strict=True):
            if row["kind"] == WallKind.FRICTION:
                axis = int(row["axis"])
                off = clearances[GHOSTS : GHOSTS + self.grid.cells[1 - axis] + 1] > SMALLEST_GAP * self.grid.cell_size
                found.append(WallGap(axis, bool(row["sign"] > 0.0), off[:-1] & off[1:]))
        return found

    def _join(self, clearances: NDArray[np.float64], along: int) -> None:
        """Give nodes that are one and the same across a periodic axis the least of their clearances."""
        nodes, cells = self.grid.shape[along], self.grid.cells[along]
        for low in range(min(cells, nodes - cells)):
            copies = clearances[low:nodes:cells]
            copies[:] = copies.min()


@cache
def _make_narrow(precision: str) -> Callable[..., Any]:
    """A kernel that narrows clearances along rows to those of points in a precision; the first thread's hold all."""
    access = position_access(precision)
    along, density = access.along, access.density

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{precision}_{CORE_MARK}")
    def narrow(  # type: ignore[no-untyped-def]
        near, starts, rows, storage, mass, least_density, origin, cell_size, offset, width, of_threads
    ):
        threads, inverse_size, last_first = len(of_threads), 1.0 / cell_size, of_threads.shape[2] - width
        farthest, nothing = 0.5 * width * cell_size, ROUND_OFF * cell_size
        for thread in prange(threads):
            for number in range(len(rows)):
                axis, position, nodes = rows[number].axis, rows[number].position, of_threads[thread, number]
                start, count = starts[number], starts[number + 1] - starts[number]
                for p in near[start + count * thread // threads : start + count * (thread + 1) // threads]:
                    distance = abs(along(storage, axis, p) - position)
                    if distance < farthest:
                        beyond = along(storage, 1 - axis, p) - origin[1 - axis]
                        first = min(int(beyond * inverse_size - offset), last_first)
                        clearance = distance - 0.5 * np.sqrt(mass / max(density(storage, p), least_density))
                        clearance = clearance if clearance > nothing else 0.0
                        for node in range(first, first + width):
                            nodes[node] = min(nodes[node], clearance)
        for thread in range(1, threads):
            np.minimum(of_threads[0], of_threads[thread], of_threads[0])

    return narrow
