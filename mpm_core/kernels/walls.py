"""Walls on the sides of the domain.

A wall lies on a line of nodes. The shape functions interpolate there (see `basis`), so that the velocity of the wall
row is the velocity of the material at the wall, and all that a wall does is done to that row.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.active_nodes import ActiveNodes
from grainlaw.mpm_core.grid.grid import GHOSTS, MASS, NEW_VX, NEW_VY, OLD_VX, OLD_VY, Grid
from grainlaw.mpm_core.kernels.sources import CORE_MARK


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


class TakenByWalls(NamedTuple):
    """Energies of one step [J/m]: what the walls take in all, and what of it sliding friction dissipates.

    The rest is what walls stop and, where they slide themselves, the work that they do (negative).
    """

    work: float
    friction: float


# A wall to compiled code: what it does, where it lies [m], and which of its row of nodes are active: the number along
# the wall of the first one and of all, where the first one is in `Grid.nodes`, and how far it is to the next.
HELD_ROW = np.dtype(
    [
        ("kind", np.int64),
        ("axis", np.int64),
        ("sign", np.float64),
        ("position", np.float64),
        ("coefficient", np.float64),
        ("velocity", np.float64),
        ("first", np.int64),
        ("count", np.int64),
        ("start", np.int64),
        ("along", np.int64),
    ]
)


def active_rows(walls: Sequence[Wall], grid: Grid, active: ActiveNodes) -> NDArray[np.void]:
    """The active rows of nodes of those walls that have any, as `HELD_ROW`."""
    rows = [_held_row(wall, grid, active) for wall in walls if _is_active(wall, grid, active)]
    return np.array(rows, HELD_ROW)


def _row_of_wall(wall: Wall, grid: Grid) -> int:
    return GHOSTS if wall.is_lower else grid.cells[wall.axis] + GHOSTS


def _is_active(wall: Wall, grid: Grid, active: ActiveNodes) -> bool:
    first, last = active.along(wall.axis)
    return first <= _row_of_wall(wall, grid) <= last


def _held_row(wall: Wall, grid: Grid, active: ActiveNodes) -> tuple[float, ...]:
    axis, other = wall.axis, 1 - wall.axis
    sign, position = (1.0, grid.lower[axis]) if wall.is_lower else (-1.0, grid.upper[axis])
    first, last = active.along(other)
    start = _row_of_wall(wall, grid) * grid.strides[axis] + first * grid.strides[other]
    does = int(wall.kind), axis, sign, position, wall.coefficient, wall.velocity
    return *does, first, last - first + 1, start, grid.strides[other]


def hold_at_walls(grid: Grid, rows: NDArray[np.void], clearances: NDArray[np.float64], dt: float) -> TakenByWalls:
    """Apply walls to the new velocities of their rows of nodes. Returns the energies that the walls take.

    A node of a friction wall comes no closer in a step of dt [s] than its clearance [m] (`wall_clearance`).

    Energy is counted as impulse times the mean of old and new velocity, which is zero for what stays at rest; friction
    as the tangential impulse of a friction wall times the mean sliding velocity.
    """
    return TakenByWalls(*_hold(grid.nodes, rows, clearances, dt))


@njit(error_model="numpy", cache=True)
@named(CORE_MARK)
def _hold(nodes, rows, clearances, dt):  # type: ignore[no-untyped-def]
    taken, dissipated = 0.0, 0.0
    for number in range(len(rows)):
        row = rows[number]
        axis, sign, wall_velocity = row.axis, row.sign, row.velocity
        for k in range(row.count):
            node = row.start + k * row.along
            mass = nodes[node + MASS]
            if mass <= 0.0:
                continue
            free_normal, free_tangential = nodes[node + NEW_VX + axis], nodes[node + NEW_VY - axis]
            old_normal, old_tangential = nodes[node + OLD_VX + axis], nodes[node + OLD_VY - axis]
            normal, tangential = free_normal, free_tangential
            allowed = clearances[number, row.first + k] / dt
            excess = max(0.0, -sign * normal - allowed)
            if row.kind == WallKind.NO_SLIP:
                normal, tangential = 0.0, wall_velocity
            elif row.kind == WallKind.FREE_SLIP:
                normal = 0.0
            elif excess > 0.0:
                normal = 0.0 - sign * allowed
                sliding = tangential - wall_velocity
                tangential = wall_velocity + np.copysign(max(0.0, abs(sliding) - row.coefficient * excess), sliding)
            nodes[node + NEW_VX + axis] = normal
            nodes[node + NEW_VY - axis] = tangential
            taken += 0.5 * mass * (free_normal - normal) * (old_normal + normal)
            taken += 0.5 * mass * (free_tangential - tangential) * (old_tangential + tangential)
            if row.kind == WallKind.FRICTION:
                sliding = old_tangential + tangential - 2.0 * wall_velocity
                dissipated += 0.5 * mass * (free_tangential - tangential) * sliding
    return taken, dissipated
