"""Walls on the sides of the domain.

A wall lies on a layer of nodes: a line in two axes, a plane in three. The shape functions interpolate there (see
`shape_functions`), so that the velocity of a node of the wall is the velocity of the material at the wall, and all that
a wall does is done to that layer.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.active_nodes import ActiveNodes
from grainlaw.mpm_core.grid.grid import COMPONENTS, GHOSTS, NODE_OF, Grid
from grainlaw.mpm_core.kernels.sources import CORE_MARK


class WallKind(IntEnum):
    """What a wall does to the velocity of the material at it."""

    FREE_SLIP = 0
    NO_SLIP = 1
    FRICTION = 2


@dataclass(frozen=True)
class Wall:
    """The lower or the upper side of the domain along an axis. A friction wall is unilateral: material may leave it.

    The others hold it. A wall may slide along itself at `velocity` [m/s], a component for each axis.
    """

    axis: int
    is_lower: bool
    kind: WallKind
    coefficient: float
    velocity: tuple[float, ...]


class TakenByWalls(NamedTuple):
    """Energies of one step [J and the space's amount].

    work       what the walls take in all: what they stop and, where they slide themselves, what they do (negative)
    friction   what of it sliding friction dissipates
    of_forces  by how much the work of the forces on the nodes changes, as walls change the mean velocity of the step
    """

    work: float
    friction: float
    of_forces: float


# A wall to compiled code: what it does, where it lies [m] and how fast it slides; which nodes of its layer are active,
# along the one or two axes in it (of a single one the second has one node): the first and how many, the distances in
# `Grid.nodes` from one to the next, in nodes, and between which numbers nodes are counted, as there are copies of them
# beyond periodic sides; where the first of all is, and how many nodes the whole layer has along the second axis.
HELD_LAYER = np.dtype(
    [
        ("kind", np.int64),
        ("axis", np.int64),
        ("sign", np.float64),
        ("position", np.float64),
        ("coefficient", np.float64),
        ("velocity", np.float64, 3),
        ("first", np.int64, 2),
        ("count", np.int64, 2),
        ("stride", np.int64, 2),
        ("counted_from", np.int64, 2),
        ("counted_before", np.int64, 2),
        ("start", np.int64),
        ("breadth", np.int64),
    ]
)


def axes_along(axis: int, axes: int) -> tuple[int, ...]:
    """The axes in the layer of a wall across an axis."""
    return tuple(other for other in range(axes) if other != axis)


def active_layers(
    walls: Sequence[Wall], grid: Grid, active: ActiveNodes, periodic_axes: Sequence[int]
) -> NDArray[np.void]:
    """The active layers of nodes of those walls that have any, as `HELD_LAYER`."""
    found = [_held_layer(wall, grid, active, periodic_axes) for wall in walls if _is_active(wall, grid, active)]
    return np.array(found, HELD_LAYER)


def _layer_of_wall(wall: Wall, grid: Grid) -> int:
    return GHOSTS if wall.is_lower else grid.cells[wall.axis] + GHOSTS


def _is_active(wall: Wall, grid: Grid, active: ActiveNodes) -> bool:
    return active.first[wall.axis] <= _layer_of_wall(wall, grid) <= active.last[wall.axis]


def _held_layer(wall: Wall, grid: Grid, active: ActiveNodes, periodic_axes: Sequence[int]) -> tuple[Any, ...]:
    axis, along = wall.axis, axes_along(wall.axis, grid.space.axes)
    sign, position = (1.0, grid.lower[axis]) if wall.is_lower else (-1.0, grid.upper[axis])
    velocity = (*wall.velocity, 0.0)[:3]
    first = [active.first[other] for other in along]
    count = [active.last[other] - active.first[other] + 1 for other in along]
    stride = [grid.strides[other] for other in along]
    counted_from = [GHOSTS if other in periodic_axes else 0 for other in along]
    counted_before = [GHOSTS + grid.cells[other] if other in periodic_axes else grid.shape[other] for other in along]
    start = _layer_of_wall(wall, grid) * grid.strides[axis] + sum(np.multiply(first, stride))
    breadth = grid.shape[along[1]] if len(along) > 1 else 1
    extents = [first, count, stride, counted_from, counted_before]
    if len(along) == 1:
        extents = [[*values, of_second] for values, of_second in zip(extents, (0, 1, 0, 0, 1), strict=True)]
    does = int(wall.kind), axis, sign, position, wall.coefficient, velocity
    return *does, *map(tuple, extents), start, breadth


def hold_at_walls(grid: Grid, layers: NDArray[np.void], clearances: NDArray[np.float64], dt: float) -> TakenByWalls:
    """Apply walls to the new velocities of their layers of nodes. Returns the energies that the walls take.

    A node of a friction wall comes no closer in a step of dt [s] than its clearance [m] (`wall_clearance`).

    Energy is counted as impulse times the mean of old and new velocity, which is zero for what stays at rest; friction
    as the tangential impulse of a friction wall times the mean sliding velocity. What acted on a node before has given
    it its velocity without the wall less the old one, an impulse whose work changes by half of the change of the new
    velocity.
    """
    return TakenByWalls(*_make_hold(grid.space.axes)(grid.nodes, layers, clearances, dt))


@cache
def _make_hold(axes: int) -> Callable[..., Any]:
    of_mass, of_new, of_old = NODE_OF[axes].mass, NODE_OF[axes].momentum, NODE_OF[axes].force
    hold_node = _make_hold_node(axes)

    @njit(error_model="numpy", cache=True)
    @named(f"{axes}_{CORE_MARK}")
    def hold(nodes, layers, clearances, dt):  # type: ignore[no-untyped-def]
        taken, dissipated, of_forces, free = 0.0, 0.0, 0.0, np.empty(axes)
        for number in range(len(layers)):
            layer = layers[number]
            for k in range(layer.first[0], layer.first[0] + layer.count[0]):
                for m in range(layer.first[1], layer.first[1] + layer.count[1]):
                    along = (k - layer.first[0]) * layer.stride[0] + (m - layer.first[1]) * layer.stride[1]
                    node = (layer.start + along) * COMPONENTS
                    mass = nodes[node + of_mass]
                    if mass <= 0.0:
                        continue
                    allowed = clearances[number, k * layer.breadth + m] / dt
                    hold_node(nodes, node + of_new, layer, allowed, free)
                    is_counted = layer.counted_from[0] <= k < layer.counted_before[0]
                    if not (is_counted and layer.counted_from[1] <= m < layer.counted_before[1]):
                        continue
                    for axis in range(axes):
                        old, new = nodes[node + of_old + axis], nodes[node + of_new + axis]
                        half_impulse = 0.5 * mass * (free[axis] - new)
                        taken += half_impulse * (old + new)
                        of_forces -= half_impulse * (free[axis] - old)
                        if layer.kind == WallKind.FRICTION and axis != layer.axis:
                            dissipated += half_impulse * (old + new - 2.0 * layer.velocity[axis])
        return taken, dissipated, of_forces

    return hold


def _make_hold_node(axes: int) -> Callable[..., Any]:
    """A function that applies a wall to the new velocity at `new`, which may go on by `allowed` [m/s] towards it.

    `free` receives the velocity without the wall.
    """

    @register_jitable
    @named(f"{axes}_{CORE_MARK}")
    def hold_node(nodes, new, layer, allowed, free):  # type: ignore[no-untyped-def]
        squared = 0.0
        for axis in range(axes):
            free[axis] = nodes[new + axis]
            if axis != layer.axis:
                squared += (free[axis] - layer.velocity[axis]) ** 2
        excess = max(0.0, -layer.sign * free[layer.axis] - allowed)
        # what is left of the sliding velocity
        share = 1.0
        if layer.kind == WallKind.NO_SLIP:
            nodes[new + layer.axis], share = 0.0, 0.0
        elif layer.kind == WallKind.FREE_SLIP:
            nodes[new + layer.axis] = 0.0
        elif excess > 0.0:
            nodes[new + layer.axis] = 0.0 - layer.sign * allowed
            sliding = np.sqrt(squared)
            share = max(0.0, 1.0 - layer.coefficient * excess / sliding) if sliding > 0.0 else 0.0
        if share < 1.0:
            for axis in range(axes):
                if axis != layer.axis:
                    nodes[new + axis] = layer.velocity[axis] + share * (free[axis] - layer.velocity[axis])

    return hold_node
