"""Contact of material points with obstacles: impulses at their surface, found together by projected Jacobi iterations.

A point whose edge is within a quarter of a cell of a surface is in reach of it. With the distance phi and the normal n
at the point, half its size r (`wall_clearance`), the gap is g = max(0, phi - r), and contact is at x_c = x_p - e n with
the lever e = max(0, min(r, phi)). The weights

    W_i = w_i [1 - e n.D^-1 (x_i - x_p)]

reproduce linear fields at x_c, so that force and torque are those at the surface. An impulse J at x_c changes the new
velocities of the nodes by W_i J/m_i. With the approach R = sum W_i v_i - V_o(x_c) + n g/dt, contacts that approach or
carry something are active, and in each iteration

    J* = J - R/d,  d = sum_i |W_i| s_i/m_i,  s_i = sum of |W_i| over the active contacts,
    J_n = max(0, J*.n),  J_t = J*_t min(1, mu J_n/|J*_t|).

d bounds a row of the contact matrix: no iteration overshoots, and there is nothing to tune. Nothing is kept from step
to step. Contacts are taken in the order of the points by a single thread, so that sums come out the same for any number
of threads.
"""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.grid import COMPONENTS, Grid
from grainlaw.mpm_core.kernels.point_size import make_size_of
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.shape_functions import Basis, make_stencil
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.obstacles.impulses import make_solve
from grainlaw.mpm_core.obstacles.obstacle import Obstacle, as_rows, put_pose
from grainlaw.mpm_core.obstacles.surface import distance_in_frame
from grainlaw.mpm_core.space import Space

# Cells between the edge of a point and a surface within which they may touch in a step.
IN_REACH = 0.25


class Contacts(NamedTuple):
    """The contacts of a step; arrays are as long as there may be any, the first `count` are there.

    obstacle     number of the obstacle
    first        number of the first node of the stencil
    weights      W of each node of the stencil, shape (contacts, nodes)
    normal       n, shape (contacts, axes)
    lever        from the obstacle's position to x_c, shape (contacts, axes) [m]
    gap          g [m]
    approach     R, shape (contacts, axes) [m/s]
    unhindered   R without contact, shape (contacts, axes) [m/s]
    impulse      J, shape (contacts, axes)
    is_active    whether a contact is active in an iteration
    """

    obstacle: NDArray[np.int64]
    first: NDArray[np.int64]
    weights: NDArray[np.float64]
    normal: NDArray[np.float64]
    lever: NDArray[np.float64]
    gap: NDArray[np.float64]
    approach: NDArray[np.float64]
    unhindered: NDArray[np.float64]
    impulse: NDArray[np.float64]
    is_active: NDArray[np.bool_]


def _no_contacts(most: int, axes: int, nodes: int) -> Contacts:
    return Contacts(
        obstacle=np.zeros(most, np.int64),
        first=np.zeros(most, np.int64),
        weights=np.zeros((most, nodes)),
        normal=np.zeros((most, axes)),
        lever=np.zeros((most, axes)),
        gap=np.zeros(most),
        approach=np.zeros((most, axes)),
        unhindered=np.zeros((most, axes)),
        impulse=np.zeros((most, axes)),
        is_active=np.zeros(most, np.bool_),
    )


class TakenByObstacles(NamedTuple):
    """What the obstacles take in one step; amounts as the space has them.

    work       energy in all [J]
    friction   what of it sliding dissipates [J]
    of_forces  by how much the work of the forces on the nodes changes, as contact changes the mean velocity of the
               step (`kernels.walls`) [J]
    impulses   of each obstacle: impulse [N s], and its moment about the position of its frame [N m s], shape (n, 6)
    """

    work: float
    friction: float
    of_forces: float
    impulses: NDArray[np.float64]


class ObstacleContact:
    """The points that may come into reach of the obstacles before the next sort, and their contact."""

    def __init__(
        self, obstacles: Sequence[Obstacle], bodies: Sequence[Body], grid: Grid, basis: Basis, margin: float
    ) -> None:
        """Find them; `margin` [cells] is by how much a point and an obstacle may approach until then."""
        self.obstacles = obstacles
        self.bodies = bodies
        self.grid = grid
        self.basis = basis
        self._rows, self._numbers = rows, numbers = as_rows(obstacles)
        reach = (IN_REACH + margin) * grid.cell_size
        self.pairs = [
            _make_find_pairs(body.space, body.precision)(body.storage, body.awake, rows, numbers, *_size(body), reach)
            for body in bodies
        ]
        most = sum(len(pairs) for pairs in self.pairs)
        self._contacts = _no_contacts(most, grid.space.axes, basis.width**grid.space.axes)
        self._shares = np.zeros(len(grid.nodes) // COMPONENTS if most > 0 else 0)

    def apply(self, dt: float) -> TakenByObstacles:
        """Apply contact to the new velocities of the nodes in a step of dt [s]."""
        grid, rows, numbers, count = self.grid, self._rows, self._numbers, 0
        for row, obstacle in zip(rows, self.obstacles, strict=True):
            if not obstacle.motion.is_fixed:
                put_pose(row, obstacle.motion.pose)
        impulses = np.zeros((len(self.obstacles), 6))
        for body, pairs in zip(self.bodies, self.pairs, strict=True):
            if len(pairs) > 0:
                find = _make_find_contacts(body.space, self.basis, body.precision)
                place = grid.strides, grid.ghosts, grid.origin, grid.cell_size
                count = find(body.storage, pairs, rows, numbers, *_size(body), *place, self._contacts, count)
        if count == 0:
            return TakenByObstacles(0.0, 0.0, 0.0, impulses)
        solve = make_solve(grid.space.axes, self.basis)
        taken = solve(grid.nodes, grid.strides, self._contacts, count, rows, dt, self._shares, impulses)
        work, friction, of_forces = taken
        return TakenByObstacles(work, friction, of_forces, impulses)


def _size(body: Body) -> tuple[float, float]:
    return body.point_mass, body.initial_density


@register_jitable
@named(CORE_MARK)
def _distance(obstacle, numbers, place, local, normal):  # type: ignore[no-untyped-def]
    """The signed distance of a place in space from an obstacle; `normal` receives its gradient."""
    axes, turn = len(place), obstacle.rotation
    for i in range(axes):
        local[i] = 0.0
        for j in range(axes):
            local[i] += turn[3 * j + i] * (place[j] - obstacle.position[j])
    of_surface = numbers[obstacle.start : obstacle.end]
    distance = obstacle.sign * distance_in_frame(obstacle.kind, of_surface, local, normal)
    for i in range(axes):
        local[i] = normal[i]
    for i in range(axes):
        normal[i] = 0.0
        for j in range(axes):
            normal[i] += obstacle.sign * turn[3 * i + j] * local[j]
    return distance


@njit(error_model="numpy", cache=True)
@named(CORE_MARK)
def _distances(positions, obstacles, numbers, found):  # type: ignore[no-untyped-def]
    axes = positions.shape[0]
    place, local, normal = np.empty(axes), np.empty(axes), np.empty(axes)
    for p in range(positions.shape[1]):
        for axis in range(axes):
            place[axis] = positions[axis, p]
        found[p] = _distance(obstacles[0], numbers, place, local, normal)


def distances(obstacle: Obstacle, positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Signed distances [m] of places, shape (axes, n) [m], from an obstacle; negative inside it, shape (n,)."""
    found = np.empty(positions.shape[1])
    _distances(positions, *as_rows([obstacle]), found)
    return found


@cache
def _make_find_pairs(space: Space, precision: str) -> Callable[..., Any]:
    """A kernel that finds the pairs of points and obstacles that are within some distance, in the order of points."""
    axes, along, size_of = space.axes, position_access(space, precision).along, make_size_of(space, precision)

    @njit(error_model="numpy", cache=True)
    @named(f"{space.name}_{precision}_{CORE_MARK}")
    def find_pairs(storage, count, obstacles, numbers, mass, least_density, reach):  # type: ignore[no-untyped-def]
        place, local, normal = np.empty(axes), np.empty(axes), np.empty(axes)
        found, pairs = 0, np.empty((64, 2), np.int64)
        for p in range(count):
            for axis in range(axes):
                place[axis] = along(storage, axis, p)
            size = 0.5 * size_of(storage, p, mass, least_density)
            for number in range(len(obstacles)):
                if _distance(obstacles[number], numbers, place, local, normal) - size < reach:
                    if found == len(pairs):
                        longer = np.empty((2 * found, 2), np.int64)
                        longer[:found] = pairs
                        pairs = longer
                    pairs[found, 0], pairs[found, 1] = p, number
                    found += 1
        return pairs[:found].copy()

    return find_pairs


@cache
def _make_find_contacts(space: Space, basis: Basis, precision: str) -> Callable[..., Any]:
    """A kernel that appends the contacts of a body to `contacts`, of which `count` are there; returns their number."""
    axes, along, size_of = space.axes, position_access(space, precision).along, make_size_of(space, precision)
    put_weights, mark = _make_put_weights(axes, basis), f"{space.name}_{basis.name}_{precision}_{CORE_MARK}"

    @njit(error_model="numpy", cache=True)
    @named(mark)
    def find_contacts(  # type: ignore[no-untyped-def]
        storage, pairs, obstacles, numbers, mass, least_density, strides, ghosts, origin, cell_size, contacts, count
    ):
        place, local, normal = np.empty(axes), np.empty(axes), np.empty(axes)
        for k in range(len(pairs)):
            p, number = pairs[k]
            obstacle = obstacles[number]
            for axis in range(axes):
                place[axis] = along(storage, axis, p)
            half = 0.5 * size_of(storage, p, mass, least_density)
            distance = _distance(obstacle, numbers, place, local, normal)
            if distance - half < IN_REACH * cell_size:
                lever = max(0.0, min(half, distance))
                contacts.obstacle[count] = number
                contacts.gap[count] = max(0.0, distance - half)
                for axis in range(axes):
                    contacts.normal[count, axis] = normal[axis]
                    contacts.lever[count, axis] = place[axis] - lever * normal[axis] - obstacle.position[axis]
                    contacts.impulse[count, axis] = 0.0
                contacts.first[count] = put_weights(
                    place, normal, lever, strides, ghosts, origin, cell_size, contacts.weights[count]
                )
                count += 1
        return count

    return find_contacts


def _make_put_weights(axes: int, basis: Basis) -> Callable[..., Any]:
    """A function that stores W of the nodes of a point's stencil, and returns the number of its first node."""
    width, stencil = basis.width, make_stencil(basis)
    nodes = width**axes

    @register_jitable
    @named(f"{axes}_{basis.name}_{CORE_MARK}")
    def put_weights(place, normal, lever, strides, ghosts, origin, cell_size, weights):  # type: ignore[no-untyped-def]
        first, of_axes, slopes = 0, np.empty((axes, width)), np.empty((axes, width))
        for axis in range(axes):
            in_cells = (place[axis] - origin[axis]) / cell_size
            i, f, w, _, per_moment = stencil(in_cells, ghosts[2 * axis], ghosts[2 * axis + 1])
            first += int(i) * strides[axis]
            for a in range(width):
                of_axes[axis, a] = w[a]
                slopes[axis, a] = normal[axis] * (a - f) * per_moment / cell_size
        for node in range(nodes):
            weight, slope, rest = 1.0, 0.0, node
            for back in range(axes):
                axis = axes - 1 - back
                weight *= of_axes[axis, rest % width]
                slope += slopes[axis, rest % width]
                rest //= width
            weights[node] = weight * (1.0 - lever * slope)
        return first

    return put_weights
