"""Walls on the sides of the domain, and periodic sides.

A wall lies on a line of nodes. The shape functions interpolate there (see `basis`), so that the velocity of the wall
row is the velocity of the material at the wall, and all that a wall does is done to that row.
"""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from materials.compilation import named
from mpm_core.grid import COMPONENTS, GHOSTS, MASS, NEW_VX, NEW_VY, OLD_VX, OLD_VY, Grid
from mpm_core.reach import Reach
from mpm_core.sources import CORE_MARK


class WallKind(IntEnum):
    """What a wall does to the velocity of the material at it."""

    FREE_SLIP = 0
    NO_SLIP = 1
    FRICTION = 2


SIDES = ("left", "right", "bottom", "top")


@dataclass(frozen=True)
class Wall:
    """One side of the domain. A friction wall is unilateral: material may leave it; the others hold it.

    A wall may slide along itself at `velocity` [m/s], along x for bottom and top, along y for left and right.
    """

    side: str
    kind: WallKind
    coefficient: float = 0.0
    velocity: float = 0.0

    @property
    def axis(self) -> int:
        """0 for the left and right sides, 1 for bottom and top."""
        return 0 if self.side in ("left", "right") else 1

    @property
    def is_lower(self) -> bool:
        """Whether the domain lies on the positive side of the wall."""
        return self.side in ("left", "bottom")


class TakenByWall(NamedTuple):
    """Energies of one step [J/m]: what the wall takes in all, and what of it sliding friction dissipates.

    The rest is what the wall stops and, where it slides itself, the work that it does (negative).
    """

    work: float
    friction: float


def row_of_wall(grid: Grid, wall: Wall) -> int:
    """Number of the row of nodes on a wall."""
    return GHOSTS if wall.is_lower else grid.cells[wall.axis] + GHOSTS


def is_in_reach(grid: Grid, wall: Wall, reach: Reach) -> bool:
    """Whether the row of nodes on a wall has any in reach."""
    first, last = reach.along(wall.axis)
    return first <= row_of_wall(grid, wall) <= last


def hold_at_wall(grid: Grid, wall: Wall, reach: Reach, gaps: NDArray[np.float64], dt: float) -> TakenByWall:
    """Apply a wall in reach to the new velocities of its row of nodes. Returns the energies that the wall takes.

    A node of a friction wall comes no closer in a step of dt [s] than its gap [m] (`contact`).

    Energy is counted as impulse times the mean of old and new velocity, which is zero for what stays at rest; friction
    as the tangential impulse of a friction wall times the mean sliding velocity.
    """
    other = 1 - wall.axis
    first, last = reach.along(other)
    start = row_of_wall(grid, wall) * grid.strides[wall.axis] + first * grid.strides[other]
    count = last - first + 1
    sign = 1.0 if wall.is_lower else -1.0
    work, friction = _hold(
        grid.nodes,
        start,
        grid.strides[other],
        count,
        wall.axis,
        sign,
        int(wall.kind),
        wall.coefficient,
        wall.velocity,
        gaps[first : last + 1] / dt,
    )
    return TakenByWall(float(work), float(friction))


@njit(cache=True)
@named(CORE_MARK)
def _hold(  # type: ignore[no-untyped-def]
    nodes, start, along, count, axis, sign, kind, friction, wall_velocity, allowed
):
    taken, dissipated = 0.0, 0.0
    for k in range(count):
        node = start + k * along
        mass = nodes[node + MASS]
        if mass <= 0.0:
            continue
        free_normal, free_tangential = nodes[node + NEW_VX + axis], nodes[node + NEW_VY - axis]
        old_normal, old_tangential = nodes[node + OLD_VX + axis], nodes[node + OLD_VY - axis]
        normal, tangential = free_normal, free_tangential
        excess = max(0.0, -sign * normal - allowed[k])
        if kind == WallKind.NO_SLIP:
            normal, tangential = 0.0, wall_velocity
        elif kind == WallKind.FREE_SLIP:
            normal = 0.0
        elif excess > 0.0:
            normal = 0.0 - sign * allowed[k]
            sliding = tangential - wall_velocity
            tangential = wall_velocity + np.copysign(max(0.0, abs(sliding) - friction * excess), sliding)
        nodes[node + NEW_VX + axis] = normal
        nodes[node + NEW_VY - axis] = tangential
        taken += 0.5 * mass * (free_normal - normal) * (old_normal + normal)
        taken += 0.5 * mass * (free_tangential - tangential) * (old_tangential + tangential)
        if kind == WallKind.FRICTION:
            sliding = old_tangential + tangential - 2.0 * wall_velocity
            dissipated += 0.5 * mass * (free_tangential - tangential) * sliding
    return taken, dissipated


def join_periodic(nodes: NDArray[np.float64], grid: Grid, axis: int) -> None:
    """Add up the nodes that are one and the same across a periodic axis, and give all copies the sum."""
    _join(nodes, grid.strides[axis], grid.strides[1 - axis], grid.shape[axis], grid.shape[1 - axis], grid.cells[axis])


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
