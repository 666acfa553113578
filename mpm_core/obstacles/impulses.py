"""The impulses of all contacts together: the projected Jacobi iterations of `contact`."""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.grid import COMPONENTS, NODE_OF
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.sources import CORE_MARK

# Iterations of a step: with four a block slides and sticks as on a wall of the domain.
ITERATIONS = 4


class _Access(NamedTuple):
    """Functions that other kernels are made of.

    number_of         (first, node, strides) -> number of a node of a stencil in the grid
    velocity_at       (nodes, component, contacts, c, strides, axis) -> sum W_i v_i, of new or old velocities
    surface_velocity  (obstacle, lever, axis) -> V_o at x_c
    """

    number_of: Callable[..., Any]
    velocity_at: Callable[..., Any]
    surface_velocity: Callable[..., Any]


@cache
def make_solve(axes: int, basis: Basis) -> Callable[..., Any]:
    """A kernel that finds the impulses and applies them to the nodes; returns the energies of `TakenByObstacles`.

    `shares` is zero for each node of the grid before and after. `impulses` receives what acts on each obstacle: the
    impulse and its moment about the obstacle's position.
    """
    access = _make_access(axes, basis)
    find_approaches, iterate = _make_find_approaches(axes, basis, access), _make_iterate(axes, basis, access)
    count_taken = _make_count_taken(axes, basis, access)

    @njit(error_model="numpy", cache=True)
    @named(f"{axes}_{basis.name}_{CORE_MARK}")
    def solve(nodes, strides, contacts, count, obstacles, dt, shares, impulses):  # type: ignore[no-untyped-def]
        change = np.empty(axes)
        for iteration in range(ITERATIONS):
            find_approaches(nodes, strides, contacts, count, obstacles, dt)
            if iteration == 0:
                contacts.unhindered[:count] = contacts.approach[:count]
            iterate(nodes, strides, contacts, count, obstacles, shares, change)
        return count_taken(nodes, strides, contacts, count, obstacles, dt, impulses)

    return solve


def _make_access(axes: int, basis: Basis) -> _Access:
    width, nodes_of_stencil = basis.width, basis.width**axes
    mark = f"{axes}_{basis.name}_{CORE_MARK}"

    @register_jitable(forceinline=True)
    @named(mark)
    def number_of(first, node, strides):  # type: ignore[no-untyped-def]
        number, rest = first, node
        for back in range(axes):
            number += (rest % width) * strides[axes - 1 - back]
            rest //= width
        return number

    @register_jitable
    @named(mark)
    def velocity_at(nodes, component, contacts, c, strides, axis):  # type: ignore[no-untyped-def]
        velocity = 0.0
        for node in range(nodes_of_stencil):
            at = number_of(contacts.first[c], node, strides) * COMPONENTS + component + axis
            velocity += contacts.weights[c, node] * nodes[at]
        return velocity

    @register_jitable
    @named(mark)
    def surface_velocity_2d(obstacle, lever, axis):  # type: ignore[no-untyped-def]
        turning = -obstacle.spin[2] * lever[1] if axis == 0 else obstacle.spin[2] * lever[0]
        return obstacle.velocity[axis] + turning

    @register_jitable
    @named(mark)
    def surface_velocity_3d(obstacle, lever, axis):  # type: ignore[no-untyped-def]
        second, third = (axis + 1) % 3, (axis + 2) % 3
        turning = obstacle.spin[second] * lever[third] - obstacle.spin[third] * lever[second]
        return obstacle.velocity[axis] + turning

    return _Access(number_of, velocity_at, {2: surface_velocity_2d, 3: surface_velocity_3d}[axes])


def _make_find_approaches(axes: int, basis: Basis, access: _Access) -> Callable[..., Any]:
    """A function that finds R of all contacts, and which of them are active."""
    velocity_at, surface_velocity, of_new = access.velocity_at, access.surface_velocity, NODE_OF[axes].momentum

    @register_jitable
    @named(f"{axes}_{basis.name}_{CORE_MARK}")
    def find_approaches(nodes, strides, contacts, count, obstacles, dt):  # type: ignore[no-untyped-def]
        for c in range(count):
            approaching, carried, obstacle = 0.0, 0.0, obstacles[contacts.obstacle[c]]
            for axis in range(axes):
                velocity = velocity_at(nodes, of_new, contacts, c, strides, axis)
                velocity -= surface_velocity(obstacle, contacts.lever[c], axis)
                velocity += contacts.normal[c, axis] * contacts.gap[c] / dt
                contacts.approach[c, axis] = velocity
                approaching += velocity * contacts.normal[c, axis]
                carried += contacts.impulse[c, axis] * contacts.normal[c, axis]
            contacts.is_active[c] = approaching < 0.0 or carried > 0.0

    return find_approaches


def _make_iterate(axes: int, basis: Basis, access: _Access) -> Callable[..., Any]:
    """A function that changes the impulses of the active contacts, and the velocities of their nodes."""
    project, push = _make_project(axes), _make_push(axes, basis, access)
    add_shares, row_sum = _make_add_shares(axes, basis, access), _make_row_sum(axes, basis, access)

    @register_jitable
    @named(f"{axes}_{basis.name}_{CORE_MARK}")
    def iterate(nodes, strides, contacts, count, obstacles, shares, change):  # type: ignore[no-untyped-def]
        add_shares(strides, contacts, count, shares, 1)
        for c in range(count):
            if contacts.is_active[c]:
                bound = row_sum(nodes, strides, contacts, c, shares)
                project(contacts, c, bound, obstacles[contacts.obstacle[c]].friction, change)
                push(nodes, strides, contacts, c, change)
        add_shares(strides, contacts, count, shares, -1)

    return iterate


def _make_add_shares(axes: int, basis: Basis, access: _Access) -> Callable[..., Any]:
    """A function that adds |W_i| of the active contacts to the shares of nodes, or sets these to zero again."""
    nodes_of_stencil, number_of = basis.width**axes, access.number_of

    @register_jitable
    @named(f"{axes}_{basis.name}_{CORE_MARK}")
    def add_shares(strides, contacts, count, shares, sign):  # type: ignore[no-untyped-def]
        for c in range(count):
            if contacts.is_active[c]:
                for node in range(nodes_of_stencil):
                    number = number_of(contacts.first[c], node, strides)
                    shares[number] = shares[number] + abs(contacts.weights[c, node]) if sign > 0 else 0.0

    return add_shares


def _make_row_sum(axes: int, basis: Basis, access: _Access) -> Callable[..., Any]:
    """A function that gives the bound d of a row of the contact matrix [1/kg]."""
    nodes_of_stencil, number_of, of_mass = basis.width**axes, access.number_of, NODE_OF[axes].mass

    @register_jitable
    @named(f"{axes}_{basis.name}_{CORE_MARK}")
    def row_sum(nodes, strides, contacts, c, shares):  # type: ignore[no-untyped-def]
        bound = 0.0
        for node in range(nodes_of_stencil):
            number = number_of(contacts.first[c], node, strides)
            mass = nodes[number * COMPONENTS + of_mass]
            if mass > 0.0:
                bound += abs(contacts.weights[c, node]) * shares[number] / mass
        return bound

    return row_sum


def _make_push(axes: int, basis: Basis, access: _Access) -> Callable[..., Any]:
    """A function that changes the velocities of the nodes of a contact by an impulse."""
    nodes_of_stencil, number_of = basis.width**axes, access.number_of
    of_mass, of_new = NODE_OF[axes].mass, NODE_OF[axes].momentum

    @register_jitable
    @named(f"{axes}_{basis.name}_{CORE_MARK}")
    def push(nodes, strides, contacts, c, change):  # type: ignore[no-untyped-def]
        for node in range(nodes_of_stencil):
            number = number_of(contacts.first[c], node, strides)
            mass = nodes[number * COMPONENTS + of_mass]
            if mass > 0.0:
                for axis in range(axes):
                    nodes[number * COMPONENTS + of_new + axis] += contacts.weights[c, node] * change[axis] / mass

    return push


def _make_project(axes: int) -> Callable[..., Any]:
    """A function that takes an impulse to where it neither pulls nor exceeds friction; `change` says by how much."""

    @register_jitable
    @named(f"{axes}_{CORE_MARK}")
    def project(contacts, c, bound, friction, change):  # type: ignore[no-untyped-def]
        pushed, squared = 0.0, 0.0
        for axis in range(axes):
            change[axis] = contacts.impulse[c, axis] - contacts.approach[c, axis] / bound
            pushed += change[axis] * contacts.normal[c, axis]
        for axis in range(axes):
            change[axis] -= pushed * contacts.normal[c, axis]
            squared += change[axis] * change[axis]
        pushed, dragged = max(0.0, pushed), np.sqrt(squared)
        share = min(1.0, friction * pushed / dragged) if dragged > 0.0 else 0.0
        for axis in range(axes):
            impulse = pushed * contacts.normal[c, axis] + share * change[axis]
            change[axis] = impulse - contacts.impulse[c, axis]
            contacts.impulse[c, axis] = impulse

    return project


def _make_count_taken(axes: int, basis: Basis, access: _Access) -> Callable[..., Any]:
    """A function that sums up what acts on obstacles, and energies: impulse times the mean of old and new velocity."""
    velocity_at, surface_velocity = access.velocity_at, access.surface_velocity
    of_new, of_old, mark = NODE_OF[axes].momentum, NODE_OF[axes].force, f"{axes}_{basis.name}_{CORE_MARK}"

    @register_jitable
    @named(mark)
    def add_impulse(impulse, lever, sums):  # type: ignore[no-untyped-def]
        """Count the reaction of an impulse."""
        for axis in range(axes):
            sums[axis] -= impulse[axis]
        if axes == 2:
            sums[5] -= lever[0] * impulse[1] - lever[1] * impulse[0]
        else:
            for axis in range(3):
                second, third = (axis + 1) % 3, (axis + 2) % 3
                sums[3 + axis] -= lever[second] * impulse[third] - lever[third] * impulse[second]

    @register_jitable
    @named(mark)
    def count_taken(nodes, strides, contacts, count, obstacles, dt, impulses):  # type: ignore[no-untyped-def]
        work, friction, of_forces = 0.0, 0.0, 0.0
        for c in range(count):
            obstacle, normal = obstacles[contacts.obstacle[c]], 0.0
            for axis in range(axes):
                normal += contacts.impulse[c, axis] * contacts.normal[c, axis]
            for axis in range(axes):
                new = velocity_at(nodes, of_new, contacts, c, strides, axis)
                old = velocity_at(nodes, of_old, contacts, c, strides, axis)
                velocity, of_surface = 0.5 * new + 0.5 * old, surface_velocity(obstacle, contacts.lever[c], axis)
                free = contacts.unhindered[c, axis] + of_surface - contacts.normal[c, axis] * contacts.gap[c] / dt
                tangential = contacts.impulse[c, axis] - normal * contacts.normal[c, axis]
                work -= contacts.impulse[c, axis] * velocity
                friction -= tangential * (velocity - of_surface)
                of_forces += 0.5 * contacts.impulse[c, axis] * (free - old)
            add_impulse(contacts.impulse[c], contacts.lever[c], impulses[contacts.obstacle[c]])
        return work, friction, of_forces

    return count_taken
