"""P2G in three dimensions: the equations of `p2g`, without volumes and pressures, which `bulk_3d` brings."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.materials.precision import PRECISIONS
from grainlaw.mpm_core.grid.grid import COMPONENTS
from grainlaw.mpm_core.kernels.p2g_nodes_3d import P2GContributions3D, make_scatter_3d
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.simd.arithmetic import filled_like, scaled_sum
from grainlaw.mpm_core.kernels.simd.registers import LANES_OF, put, put_transposed, several_at
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stencil import GROUP_3D, make_find_stencils
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.parallel.work_sharing import chunk_ranges, next_chunk, threads_of
from grainlaw.mpm_core.space import THREE_D

_LAYOUT = layout_of(THREE_D)
_DENSITY = _LAYOUT.density
_VX, _VY, _VZ = range(_LAYOUT.velocity, _LAYOUT.velocity + 3)


def make_put_increments(axis: int) -> Callable[..., Any]:
    """A function that stores what points add from node to node along an axis, and returns it.

    That is the affine velocity and the stress on the plane across the axis, times a factor of each.
    """
    ax, ay, az = (_LAYOUT.affine + 3 * component + axis for component in range(3))
    components = (("xx", "xy", "xz"), ("xy", "yy", "yz"), ("xz", "yz", "zz"))[axis]
    sx, sy, sz = (_LAYOUT.stress + _LAYOUT.stress_names.index(name) for name in components)

    @register_jitable(forceinline=True)
    @named(f"{axis}_{CORE_MARK}")
    def put_increments(rows, p, k, affine, scale, increments):  # type: ignore[no-untyped-def]
        px, py, pz = (
            affine * several_at(rows[ax], p),
            affine * several_at(rows[ay], p),
            affine * several_at(rows[az], p),
        )
        fx, fy, fz = scale * several_at(rows[sx], p), scale * several_at(rows[sy], p), scale * several_at(rows[sz], p)
        nothing = filled_like(0.0, scale)
        put_transposed(increments, k, (px, py, pz, nothing, fx, fy, fz, nothing))
        return px, py, pz, fx, fy, fz

    return put_increments


put_increments_x, put_increments_y, put_increments_z = map(make_put_increments, range(3))


@register_jitable(forceinline=True)
def put_contributions_3d(rows, p, k, point_mass, cell_size, axes, contributions):  # type: ignore[no-untyped-def]
    """Store what the points from p on contribute, as many as are taken at once, from point k of a group on."""
    along_x, along_y, along_z = axes
    # to the first node
    x, y, z = 0.0 - along_x.place, 0.0 - along_y.place, 0.0 - along_z.place
    affine, volume = point_mass * cell_size, point_mass / several_at(rows[_DENSITY], p)
    scale = (-1.0 / cell_size) * volume
    per_x = put_increments_x(rows, p, k, affine, scale * along_x.per_moment, contributions.along_x)
    per_y = put_increments_y(rows, p, k, affine, scale * along_y.per_moment, contributions.along_y)
    per_z = put_increments_z(rows, p, k, affine, scale * along_z.per_moment, contributions.along_z)
    px = scaled_sum(
        x, per_x[0], scaled_sum(y, per_y[0], scaled_sum(z, per_z[0], point_mass * several_at(rows[_VX], p)))
    )
    py = scaled_sum(
        x, per_x[1], scaled_sum(y, per_y[1], scaled_sum(z, per_z[1], point_mass * several_at(rows[_VY], p)))
    )
    pz = scaled_sum(
        x, per_x[2], scaled_sum(y, per_y[2], scaled_sum(z, per_z[2], point_mass * several_at(rows[_VZ], p)))
    )
    fx = scaled_sum(x, per_x[3], scaled_sum(y, per_y[3], z * per_z[3]))
    fy = scaled_sum(x, per_x[4], scaled_sum(y, per_y[4], z * per_z[4]))
    fz = scaled_sum(x, per_x[5], scaled_sum(y, per_y[5], z * per_z[5]))
    mass, nothing = filled_like(point_mass, volume), filled_like(0.0, volume)
    put_transposed(contributions.values, k, (px, py, pz, mass, fx, fy, fz, nothing))


def make_put_weights_3d(basis: Basis) -> Callable[..., Any]:
    """A function that stores the weights of points, from point k of a group on."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def put_weights_3d(weights, k, along_x, along_y, along_z):  # type: ignore[no-untyped-def]
        for a in range(width):
            for b in range(width):
                in_row = along_x.weights[a] * along_y.weights[b]
                for c in range(width):
                    node = (a * width + b) * width + c
                    put(weights, node * GROUP_3D + k, in_row * along_z.weights[c])

    return put_weights_3d


@cache
def make_p2g_3d(basis: Basis, precision: str) -> Callable[..., Any]:
    """Scatter mass, momentum and internal force to the grid; the precision is that of points and grid.

    `strides` are those of the grid.
    """
    put_weights, scatter = make_put_weights_3d(basis), make_scatter_3d(basis, precision)
    find_stencils = make_find_stencils(THREE_D, basis, precision)
    rows_of_points = position_access(THREE_D, precision).rows
    nodes_of_stencil, number, at_once = basis.width**3, PRECISIONS[precision], LANES_OF[precision]

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def p2g_3d(  # type: ignore[no-untyped-def]
        storage, point_mass, stripe_starts, threads, nodes, strides, ghosts, origin, cell_size
    ):
        rows, inverse_size = rows_of_points(storage), 1.0 / cell_size
        for parity in range(2):
            ranges = chunk_ranges((len(stripe_starts) - parity) // 2, threads)
            for thread in prange(threads_of(ranges)):
                of_nodes, weights = (
                    np.empty((4, GROUP_3D * COMPONENTS), number),
                    np.empty(nodes_of_stencil * GROUP_3D, number),
                )
                contributions = P2GContributions3D(
                    np.empty(GROUP_3D), weights, of_nodes[0], of_nodes[1], of_nodes[2], of_nodes[3]
                )
                chunk = next_chunk(ranges, thread)
                while chunk >= 0:
                    begin, end = stripe_starts[2 * chunk + parity], stripe_starts[2 * chunk + parity + 1]
                    for start in range(begin, end, GROUP_3D):
                        first, last = np.uint64(start), np.uint64(min(start + GROUP_3D, end))
                        for p in range(first, last, at_once):
                            k = p - first
                            first_node, x, y, z = find_stencils(rows, p, strides, ghosts, origin, inverse_size)
                            put(contributions.first_nodes, k, first_node)
                            put_weights(contributions.weights, k, x, y, z)
                            put_contributions_3d(rows, p, k, point_mass, cell_size, (x, y, z), contributions)
                        scatter(last - first, nodes, strides, contributions)
                    chunk = next_chunk(ranges, thread)

    return p2g_3d
