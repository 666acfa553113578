"""P2G and G2P of volumes and pressures in three dimensions, for the steps that couple the volumes of points.

Both quantities of a node stand side by side in an array of their own (`Grid.bulk`), and so do those of a point on its
way: volume and volume times pressure to the nodes, mean pressure and mean density back.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.materials.precision import PRECISIONS
from grainlaw.materials.tensor import THIRD
from grainlaw.mpm_core.grid.grid import BULK_COMPONENTS
from grainlaw.mpm_core.kernels.p2g_3d import make_put_weights_3d
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.simd.arithmetic import filled_like, scaled_sum
from grainlaw.mpm_core.kernels.simd.registers import LANES_OF, pair_at, put
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stencil import GROUP_3D, make_find_stencils
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.parallel.blocks import points_of_block
from grainlaw.mpm_core.parallel.work_sharing import chunk_ranges, next_chunk, threads_of
from grainlaw.mpm_core.space import THREE_D

_LAYOUT = layout_of(THREE_D)
_DENSITY, _SXX, _SYY, _SZZ = _LAYOUT.density, _LAYOUT.stress, _LAYOUT.stress + 1, _LAYOUT.stress + 2
_NEIGHBOUR_PRESSURE, _NEIGHBOUR_DENSITY = _LAYOUT.neighbour_pressure, _LAYOUT.neighbour_density


def make_put_stencils_of_bulk(basis: Basis, precision: str) -> Callable[..., Any]:
    """A function that stores first nodes and weights of the points of a group."""
    find_stencils, put_weights = make_find_stencils(THREE_D, basis, precision), make_put_weights_3d(basis)
    at_once = LANES_OF[precision]

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def put_stencils_of_bulk(rows, first, last, strides, ghosts, origin, inverse_size, first_nodes, weights):  # type: ignore[no-untyped-def]
        for p in range(first, last, at_once):
            first_node, x, y, z = find_stencils(rows, p, strides, ghosts, origin, inverse_size)
            put(first_nodes, p - first, first_node)
            put_weights(weights, p - first, x, y, z)

    return put_stencils_of_bulk


@register_jitable(forceinline=True)
def put_volumes(rows, first, last, point_mass, pairs):  # type: ignore[no-untyped-def]
    """Store volume and volume times pressure of the points of a group."""
    for p in range(first, last):
        at, volume = np.uint64(BULK_COMPONENTS) * (p - first), point_mass / rows[_DENSITY][p]
        pairs[at] = volume
        pairs[at + np.uint64(1)] = volume * ((rows[_SXX][p] + rows[_SYY][p] + rows[_SZZ][p]) * -THIRD)


@register_jitable(forceinline=True)
def put_neighbourhood(rows, first, last, pairs):  # type: ignore[no-untyped-def]
    """Give the points of a group what was interpolated to them."""
    for p in range(first, last):
        at = np.uint64(BULK_COMPONENTS) * (p - first)
        rows[_NEIGHBOUR_PRESSURE][p], rows[_NEIGHBOUR_DENSITY][p] = pairs[at], pairs[at + np.uint64(1)]


def make_scatter_pairs(basis: Basis) -> Callable[..., Any]:
    """A function that adds the pairs of the points of a group to their nodes."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter_pairs(count, bulk, strides, first_nodes, weights, pairs):  # type: ignore[no-untyped-def]
        for k in range(count):
            first_node, pair = np.uint64(first_nodes[k]), pair_at(pairs, np.uint64(BULK_COMPONENTS) * k)
            for a in range(width):
                for b in range(width):
                    row = (first_node + np.uint64(a * strides[0] + b * strides[1])) * np.uint64(BULK_COMPONENTS)
                    for c in range(width):
                        weight = weights[np.uint64(((a * width + b) * width + c) * GROUP_3D) + k]
                        node = row + np.uint64(c * BULK_COMPONENTS)
                        put(bulk, node, scaled_sum(weight, pair, pair_at(bulk, node)))

    return scatter_pairs


def make_gather_pairs(basis: Basis) -> Callable[..., Any]:
    """A function that interpolates the nodes to the pairs of the points of a group."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def gather_pairs(count, bulk, strides, first_nodes, weights, pairs):  # type: ignore[no-untyped-def]
        for k in range(count):
            first_node = np.uint64(first_nodes[k])
            nothing = filled_like(0.0, pair_at(bulk, first_node))
            mean = nothing
            for a in range(width):
                in_plane = nothing
                for b in range(width):
                    row = (first_node + np.uint64(a * strides[0] + b * strides[1])) * np.uint64(BULK_COMPONENTS)
                    for c in range(width):
                        weight = weights[np.uint64(((a * width + b) * width + c) * GROUP_3D) + k]
                        in_plane = scaled_sum(weight, pair_at(bulk, row + np.uint64(c * BULK_COMPONENTS)), in_plane)
                mean = mean + in_plane
            put(pairs, np.uint64(BULK_COMPONENTS) * k, mean)

    return gather_pairs


@cache
def make_p2g_of_bulk(basis: Basis, precision: str) -> Callable[..., Any]:
    """Scatter volume and volume times pressure to `Grid.bulk`; arguments are those of `p2g_3d.make_p2g_3d`."""
    put_stencils, scatter_pairs = make_put_stencils_of_bulk(basis, precision), make_scatter_pairs(basis)
    rows_of_points, number = position_access(THREE_D, precision).rows, PRECISIONS[precision]
    nodes_of_stencil = basis.width**3

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def p2g_of_bulk(  # type: ignore[no-untyped-def]
        storage, point_mass, stripe_starts, threads, bulk, strides, ghosts, origin, cell_size
    ):
        rows, inverse_size = rows_of_points(storage), 1.0 / cell_size
        for parity in range(2):
            ranges = chunk_ranges((len(stripe_starts) - parity) // 2, threads)
            for thread in prange(threads_of(ranges)):
                first_nodes, weights = np.empty(GROUP_3D), np.empty(nodes_of_stencil * GROUP_3D, number)
                pairs = np.empty(BULK_COMPONENTS * GROUP_3D, number)
                chunk = next_chunk(ranges, thread)
                while chunk >= 0:
                    begin, end = stripe_starts[2 * chunk + parity], stripe_starts[2 * chunk + parity + 1]
                    for start in range(begin, end, GROUP_3D):
                        first, last = np.uint64(start), np.uint64(min(start + GROUP_3D, end))
                        put_stencils(rows, first, last, strides, ghosts, origin, inverse_size, first_nodes, weights)
                        put_volumes(rows, first, last, point_mass, pairs)
                        scatter_pairs(last - first, bulk, strides, first_nodes, weights, pairs)
                    chunk = next_chunk(ranges, thread)

    return p2g_of_bulk


@cache
def make_g2p_of_bulk(basis: Basis, precision: str) -> Callable[..., Any]:
    """Give the points pressure and density of the material around; `reports` only say how many blocks there are."""
    put_stencils, gather_pairs = make_put_stencils_of_bulk(basis, precision), make_gather_pairs(basis)
    rows_of_points, number = position_access(THREE_D, precision).rows, PRECISIONS[precision]
    nodes_of_stencil = basis.width**3

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def g2p_of_bulk(storage, count, bulk, strides, ghosts, origin, cell_size, threads, reports):  # type: ignore[no-untyped-def]
        rows, inverse_size = rows_of_points(storage), 1.0 / cell_size
        ranges = chunk_ranges(reports.shape[0], threads)
        for thread in prange(threads_of(ranges)):
            first_nodes, weights = np.empty(GROUP_3D), np.empty(nodes_of_stencil * GROUP_3D, number)
            pairs = np.empty(BULK_COMPONENTS * GROUP_3D, number)
            block = next_chunk(ranges, thread)
            while block >= 0:
                begin, end = points_of_block(block, reports.shape[0], count)
                for start in range(begin, end, GROUP_3D):
                    first, last = np.uint64(start), np.uint64(min(start + GROUP_3D, end))
                    put_stencils(rows, first, last, strides, ghosts, origin, inverse_size, first_nodes, weights)
                    gather_pairs(last - first, bulk, strides, first_nodes, weights, pairs)
                    put_neighbourhood(rows, first, last, pairs)
                block = next_chunk(ranges, thread)

    return g2p_of_bulk
