"""The gap between a friction wall and the material that comes down on it.

A friction wall is unilateral. Contact begins when the edge of the material is at the wall, not when the shape function
of the wall row first reaches a point, up to a cell and a half before. The gap of a node on the wall is that of the
nearest material in its support,

    g_i = min over the points p with w_i(x_p) > 0 of max(0, d_p - s_p/2),   s_p = sqrt(min(V_p, V_0)),

with the distance d_p of a point from the wall and its size s_p, the side of a square of its volume: a point of a full
cell of 2 x 2 points that touches a wall is a quarter of a cell away. An opened point is no larger than at the start:
what it gained is void. A point that is closer than half of its size touches, no more. The node may approach the wall by
no more than g_i in a step (`boundary`).

A minimum does not depend on the order of points, and which points can come near a wall before the next sort is found
again from where they are, so that a checkpoint need not hold any of it.
"""

from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from materials.compilation import named
from mpm_core.basis import Basis
from mpm_core.body import Body
from mpm_core.boundary import Wall, WallKind
from mpm_core.columns import DENSITY, X, Y
from mpm_core.grid import Grid
from mpm_core.reach import DRIFT
from mpm_core.sources import CORE_MARK

# Distances below this, in cells, are round-off of positions: what starts on a wall touches it.
ROUND_OFF = 1e-9


class Contact:
    """The points that may come into the support of the rows of friction walls before the next sort."""

    def __init__(
        self, walls: Sequence[Wall], bodies: Sequence[Body], grid: Grid, basis: Basis, periodic_axes: Sequence[int]
    ) -> None:
        self.bodies = bodies
        self.grid = grid
        self.basis = basis
        self.periodic_axes = periodic_axes
        self.near = {
            wall: [self._near(wall, body) for body in bodies] for wall in walls if wall.kind is WallKind.FRICTION
        }
        self.unlimited = [np.full(length, np.inf) for length in grid.shape]

    def _near(self, wall: Wall, body: Body) -> NDArray[np.int64]:
        away = np.abs(body.points[(X, Y)[wall.axis]] - _place(wall, self.grid))
        return np.flatnonzero(away < (0.5 * self.basis.width + DRIFT) * self.grid.cell_size)

    def gaps(self, wall: Wall) -> NDArray[np.float64]:
        """The gap [m] of each node along a wall; infinite where no point is in its support, or no gap is asked for."""
        grid, basis, other = self.grid, self.basis, 1 - wall.axis
        if wall not in self.near:
            return self.unlimited[other]
        gaps = self.unlimited[other].copy()
        axes = (_place(wall, grid), grid.origin[other], grid.cell_size)
        for body, near in zip(self.bodies, self.near[wall], strict=True):
            if len(near) > 0:
                away, along = body.points[(X, Y)[wall.axis]], body.points[(X, Y)[other]]
                size = (body.point_mass, body.points[DENSITY], body.initial_density)
                _narrow(near, away, along, *size, *axes, basis.offset, basis.width, gaps)
        if other in self.periodic_axes:
            copies = len(gaps) - grid.cells[other]
            gaps[:copies] = gaps[-copies:] = np.minimum(gaps[:copies], gaps[-copies:])
        return gaps


def _place(wall: Wall, grid: Grid) -> float:
    return grid.lower[wall.axis] if wall.is_lower else grid.upper[wall.axis]


@njit(error_model="numpy", cache=True)
@named(CORE_MARK)
def _narrow(  # type: ignore[no-untyped-def]
    near, away, along, mass, density, least_density, place, origin, cell_size, offset, width, gaps
):
    inverse_size = 1.0 / cell_size
    farthest, nothing = 0.5 * width * cell_size, ROUND_OFF * cell_size
    last_first = len(gaps) - width
    for p in near:
        distance = abs(away[p] - place)
        if distance < farthest:
            gap = distance - 0.5 * np.sqrt(mass / max(density[p], least_density))
            gap = gap if gap > nothing else 0.0
            first = min(int((along[p] - origin) * inverse_size - offset), last_first)
            for node in range(first, first + width):
                gaps[node] = min(gaps[node], gap)
