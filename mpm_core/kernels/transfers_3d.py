"""P2G and G2P in three dimensions, the equations of `p2g` and `g2p`.

A node holds momentum and mass, and force; volumes and pressures stand in an array of their own (`Grid.bulk`), which
only those steps need that couple volumes.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.materials.tensor import THIRD
from grainlaw.mpm_core.grid.grid import BULK_COMPONENTS, COMPONENTS, NODE_OF
from grainlaw.mpm_core.kernels.g2p import (
    HIGHEST,
    KINETIC_ENERGY,
    LOWEST,
    MAX_SPEED,
    MOMENTUM,
    OF_AXES,
    PER_AXIS,
)
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.shape_functions import Basis, make_stencil
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.parallel.blocks import points_of_block
from grainlaw.mpm_core.parallel.work_sharing import chunk_ranges, next_chunk, threads_of
from grainlaw.mpm_core.space import THREE_D

_LAYOUT, _NODE = layout_of(THREE_D), NODE_OF[3]
_VELOCITY, _GRADIENT, _AFFINE, _STRESS, _DENSITY = (
    *(_LAYOUT.velocity, _LAYOUT.gradient, _LAYOUT.affine),
    *(_LAYOUT.stress, _LAYOUT.density),
)
_NEIGHBOUR_PRESSURE, _NEIGHBOUR_DENSITY = _LAYOUT.neighbour_pressure, _LAYOUT.neighbour_density
_MOMENTUM, _FORCE, _MASS = _NODE.momentum, _NODE.force, _NODE.mass


def make_find_stencil(basis: Basis, precision: str) -> Callable[..., Any]:
    """A function that finds, of one point, its first node, and the weights, places and moments along each axis."""
    stencil, along, width = make_stencil(basis), position_access(THREE_D, precision).along, basis.width

    @register_jitable
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def find_stencil(storage, p, strides, ghosts, origin, inverse_size, weights, places, moments):  # type: ignore[no-untyped-def]
        first = 0
        for axis in range(3):
            coordinate = (along(storage, axis, p) - origin[axis]) * inverse_size
            i, f, w, moment, _ = stencil(coordinate, ghosts[2 * axis], ghosts[2 * axis + 1])
            first += int(i) * strides[axis]
            places[axis], moments[axis] = f, moment
            for a in range(width):
                weights[axis, a] = w[a]
        return first

    return find_stencil


@cache
def make_p2g_3d(basis: Basis, precision: str) -> Callable[..., Any]:  # noqa: C901
    """Scatter mass, momentum and internal force to the grid (`p2g.make_p2g`)."""
    find_stencil, width = make_find_stencil(basis, precision), basis.width

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def p2g_3d(  # type: ignore[no-untyped-def]  # noqa: C901
        storage, point_mass, stripe_starts, threads, nodes, strides, ghosts, origin, cell_size
    ):
        inverse_size = 1.0 / cell_size
        for parity in range(2):
            ranges = chunk_ranges((len(stripe_starts) - parity) // 2, threads)
            for thread in prange(threads_of(ranges)):
                weights, places, moments = np.empty((3, width)), np.empty(3), np.empty(3)
                momentum, force, way = np.empty((3, 4)), np.empty((3, 3)), np.empty(3)
                chunk = next_chunk(ranges, thread)
                while chunk >= 0:
                    for p in range(stripe_starts[2 * chunk + parity], stripe_starts[2 * chunk + parity + 1]):
                        first = find_stencil(
                            storage, p, strides, ghosts, origin, inverse_size, weights, places, moments
                        )
                        volume = point_mass / storage[_DENSITY, p]
                        xx, yy, zz = storage[_STRESS, p], storage[_STRESS + 1, p], storage[_STRESS + 2, p]
                        xy, yz, xz = storage[_STRESS + 3, p], storage[_STRESS + 4, p], storage[_STRESS + 5, p]
                        stress = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
                        for i in range(3):
                            for j in range(3):
                                momentum[i, j] = point_mass * cell_size * storage[_AFFINE + 3 * i + j, p]
                                force[i, j] = -volume * stress[i][j] * inverse_size / moments[j]
                            momentum[i, 3] = point_mass * storage[_VELOCITY + i, p]
                        for a in range(width):
                            way[0] = a - places[0]
                            for b in range(width):
                                way[1] = b - places[1]
                                row = first + a * strides[0] + b * strides[1]
                                for c in range(width):
                                    way[2] = c - places[2]
                                    weight = weights[0, a] * weights[1, b] * weights[2, c]
                                    node = (row + c) * COMPONENTS
                                    nodes[node + _MASS] += weight * point_mass
                                    for i in range(3):
                                        brought, pushed = momentum[i, 3], 0.0
                                        for j in range(3):
                                            brought += momentum[i, j] * way[j]
                                            pushed += force[i, j] * way[j]
                                        nodes[node + _MOMENTUM + i] += weight * brought
                                        nodes[node + _FORCE + i] += weight * pushed
                    chunk = next_chunk(ranges, thread)

    return p2g_3d


@cache
def make_p2g_of_bulk(basis: Basis, precision: str) -> Callable[..., Any]:
    """Scatter volume and volume times pressure to `Grid.bulk`."""
    find_stencil, width = make_find_stencil(basis, precision), basis.width

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def p2g_of_bulk(  # type: ignore[no-untyped-def]
        storage, point_mass, stripe_starts, threads, bulk, strides, ghosts, origin, cell_size
    ):
        inverse_size = 1.0 / cell_size
        for parity in range(2):
            ranges = chunk_ranges((len(stripe_starts) - parity) // 2, threads)
            for thread in prange(threads_of(ranges)):
                weights, places, moments = np.empty((3, width)), np.empty(3), np.empty(3)
                chunk = next_chunk(ranges, thread)
                while chunk >= 0:
                    for p in range(stripe_starts[2 * chunk + parity], stripe_starts[2 * chunk + parity + 1]):
                        first = find_stencil(
                            storage, p, strides, ghosts, origin, inverse_size, weights, places, moments
                        )
                        volume = point_mass / storage[_DENSITY, p]
                        pressure = -THIRD * (storage[_STRESS, p] + storage[_STRESS + 1, p] + storage[_STRESS + 2, p])
                        for a in range(width):
                            for b in range(width):
                                row, in_row = first + a * strides[0] + b * strides[1], weights[0, a] * weights[1, b]
                                for c in range(width):
                                    share = in_row * weights[2, c] * volume
                                    bulk[(row + c) * BULK_COMPONENTS] += share
                                    bulk[(row + c) * BULK_COMPONENTS + 1] += share * pressure
                    chunk = next_chunk(ranges, thread)

    return p2g_of_bulk


@cache
def make_g2p_of_bulk(basis: Basis, precision: str) -> Callable[..., Any]:
    """Give the points pressure and density of the material around; `reports` only say how many blocks there are."""
    find_stencil, width = make_find_stencil(basis, precision), basis.width

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def g2p_of_bulk(storage, count, bulk, strides, ghosts, origin, cell_size, threads, reports):  # type: ignore[no-untyped-def]
        inverse_size = 1.0 / cell_size
        ranges = chunk_ranges(reports.shape[0], threads)
        for thread in prange(threads_of(ranges)):
            weights, places, moments = np.empty((3, width)), np.empty(3), np.empty(3)
            block = next_chunk(ranges, thread)
            while block >= 0:
                begin, end = points_of_block(block, reports.shape[0], count)
                for p in range(begin, end):
                    first = find_stencil(storage, p, strides, ghosts, origin, inverse_size, weights, places, moments)
                    pressure, density = 0.0, 0.0
                    for a in range(width):
                        for b in range(width):
                            row, in_row = first + a * strides[0] + b * strides[1], weights[0, a] * weights[1, b]
                            for c in range(width):
                                weight = in_row * weights[2, c]
                                pressure += weight * bulk[(row + c) * BULK_COMPONENTS]
                                density += weight * bulk[(row + c) * BULK_COMPONENTS + 1]
                    storage[_NEIGHBOUR_PRESSURE, p], storage[_NEIGHBOUR_DENSITY, p] = pressure, density
                block = next_chunk(ranges, thread)

    return g2p_of_bulk


@cache
def make_g2p_3d(basis: Basis, precision: str) -> Callable[..., Any]:  # noqa: C901
    """Give the points velocity and its gradient, and move them (`g2p.make_g2p`)."""
    find_stencil, width, access = make_find_stencil(basis, precision), basis.width, position_access(THREE_D, precision)
    along, put_along = access.along, access.put_along

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def g2p_3d(  # type: ignore[no-untyped-def]  # noqa: C901
        storage, count, point_mass, nodes, strides, ghosts, origin, cell_size, dt, flip_fraction, threads, reports
    ):
        inverse_size = 1.0 / cell_size
        ranges = chunk_ranges(reports.shape[0], threads)
        for thread in prange(threads_of(ranges)):
            weights, places, moments = np.empty((3, width)), np.empty(3), np.empty(3)
            new, old = np.empty((3, 4)), np.empty((3, 4))
            ends, momentum, way = np.empty((2, 3)), np.empty(3), np.empty(3)
            block = next_chunk(ranges, thread)
            while block >= 0:
                twice_energy, fastest = 0.0, 0.0
                ends[0], ends[1], momentum[:] = np.inf, -np.inf, 0.0
                begin, end = points_of_block(block, reports.shape[0], count)
                for p in range(begin, end):
                    first = find_stencil(storage, p, strides, ghosts, origin, inverse_size, weights, places, moments)
                    new[:], old[:] = 0.0, 0.0
                    for a in range(width):
                        way[0] = (a - places[0]) * inverse_size / moments[0]
                        for b in range(width):
                            way[1] = (b - places[1]) * inverse_size / moments[1]
                            row = first + a * strides[0] + b * strides[1]
                            for c in range(width):
                                way[2] = (c - places[2]) * inverse_size / moments[2]
                                weight, node = weights[0, a] * weights[1, b] * weights[2, c], (row + c) * COMPONENTS
                                for i in range(3):
                                    of_new = weight * nodes[node + _MOMENTUM + i]
                                    of_old = weight * nodes[node + _FORCE + i]
                                    new[i, 3] += of_new
                                    old[i, 3] += of_old
                                    for j in range(3):
                                        new[i, j] += of_new * way[j]
                                        old[i, j] += of_old * way[j]
                    squared = 0.0
                    for i in range(3):
                        for j in range(3):
                            kept = flip_fraction * (storage[_AFFINE + 3 * i + j, p] - old[i, j])
                            storage[_GRADIENT + 3 * i + j, p] = new[i, j]
                            storage[_AFFINE + 3 * i + j, p] = new[i, j] + kept
                            twice_energy += (new[i, j] + kept) ** 2 * moments[j] * cell_size * cell_size
                        velocity = new[i, 3] + flip_fraction * (storage[_VELOCITY + i, p] - old[i, 3])
                        storage[_VELOCITY + i, p] = velocity
                        twice_energy += velocity * velocity
                        squared += new[i, 3] * new[i, 3]
                        momentum[i] += new[i, 3]
                        coordinate = along(storage, i, p) + dt * new[i, 3]
                        put_along(storage, i, p, coordinate)
                        ends[0, i], ends[1, i] = min(ends[0, i], coordinate), max(ends[1, i], coordinate)
                    fastest = max(fastest, squared)
                reports[block, KINETIC_ENERGY] = 0.5 * point_mass * twice_energy
                reports[block, MAX_SPEED] = np.sqrt(fastest)
                for i in range(3):
                    reports[block, OF_AXES + PER_AXIS * i + LOWEST] = ends[0, i]
                    reports[block, OF_AXES + PER_AXIS * i + HIGHEST] = ends[1, i]
                    reports[block, OF_AXES + PER_AXIS * i + MOMENTUM] = point_mass * momentum[i]
                block = next_chunk(ranges, thread)

    return g2p_3d
