"""P2G: what each point brings to the nodes of its stencil. Knows no law.

Affine particle-in-cell transfer (Jiang et al. 2015) with the moving-least-squares gradient (Hu et al. 2018): a point
brings the velocity field v + A (x - x_p) and the force of its stress,

    m_i += w_i m;  V_i += w_i V;  (V p)_i += w_i V p;
    (m v)_i += w_i m (v + A (x_i - x_p));  f_i -= w_i V sigma (x_i - x_p) / D.

Momentum and force are linear in the number of the node, `corner + a along_x + b along_y` for the node (a, b) of the
stencil, so that one addition leads from node to node (`scatter`).

Points come in stripes of grid columns (`sorting`). Stripes of even number are scattered first, then those of odd
number: within each half no two stripes share a node, so that the sums come out the same for any number of threads.

All arithmetic is strict. Licence to contract or reorder it would save time, but code just compiled and the same code
loaded from the disk cache then differ in the last bit, and a resumed run would not repeat the bits.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.materials.precision import PRECISIONS
from grainlaw.materials.tensor import THIRD
from grainlaw.mpm_core.grid.grid import COMPONENTS
from grainlaw.mpm_core.kernels.p2g_nodes import make_scatter
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.simd.arithmetic import filled_like, scaled_sum
from grainlaw.mpm_core.kernels.simd.registers import LANES_OF, put, put_transposed, several_at
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stencil import GROUP, make_find_stencils
from grainlaw.mpm_core.layout import AXX, AXY, AYX, AYY, DENSITY, SXX, SXY, SYY, SZZ, VX, VY
from grainlaw.mpm_core.parallel.work_sharing import chunk_ranges, next_chunk, threads_of


class P2GContributions(NamedTuple):
    """What the points of a group contribute to their nodes, in the precision of the grid.

    first_nodes       number of the first node of each point
    weights           w of each node, those of one node for the whole group side by side
    values            the components of a node, those of each point side by side, before they are weighed: momentum and
                      force at the first node, mass, volume and volume times pressure
    increments        what is added to momentum and force from node to node, along x and then along y, of each point
                      side by side
    """

    first_nodes: Any
    weights: Any
    values: Any
    increments: Any


@register_jitable(forceinline=True)
def put_contributions(rows, p, k, point_mass, cell_size, along_x, along_y, contributions):  # type: ignore[no-untyped-def]
    """Store what the points from p on contribute, as many as are taken at once, from point k of a group on."""
    # to the first node
    x, y = 0.0 - along_x.place, 0.0 - along_y.place
    affine = point_mass * cell_size
    volume = point_mass / several_at(rows[DENSITY], p)
    scale = (-1.0 / cell_size) * volume
    scale_x, scale_y = scale * along_x.per_moment, scale * along_y.per_moment
    sxx, syy, sxy = several_at(rows[SXX], p), several_at(rows[SYY], p), several_at(rows[SXY], p)
    px_x, py_x = affine * several_at(rows[AXX], p), affine * several_at(rows[AYX], p)
    px_y, py_y = affine * several_at(rows[AXY], p), affine * several_at(rows[AYY], p)
    fx_x, fy_x = scale_x * sxx, scale_x * sxy
    fx_y, fy_y = scale_y * sxy, scale_y * syy
    px = scaled_sum(x, px_x, scaled_sum(y, px_y, point_mass * several_at(rows[VX], p)))
    py = scaled_sum(x, py_x, scaled_sum(y, py_y, point_mass * several_at(rows[VY], p)))
    fx, fy = scaled_sum(x, fx_x, y * fx_y), scaled_sum(x, fy_x, y * fy_y)
    pressure = (sxx + syy + several_at(rows[SZZ], p)) * -THIRD
    bulk = filled_like(point_mass, volume), volume, volume * pressure, filled_like(0.0, volume)
    put_transposed(contributions.values, k, (px, py, fx, fy, *bulk))
    put_transposed(contributions.increments, k, (px_x, py_x, fx_x, fy_x, px_y, py_y, fx_y, fy_y))


def make_put_weights(basis: Basis) -> Callable[..., Any]:
    """A function that stores the weights of points, from point k of a group on."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def put_weights(weights, k, along_x, along_y):  # type: ignore[no-untyped-def]
        for a in range(width):
            for b in range(width):
                put(weights, (a * width + b) * GROUP + k, along_x.weights[a] * along_y.weights[b])

    return put_weights


@cache
def make_p2g(basis: Basis, precision: str) -> Callable[..., Any]:
    """Scatter mass, volume, pressure, momentum and internal force to the grid; the precision is that of both."""
    put_weights, scatter = make_put_weights(basis), make_scatter(basis)
    find_stencils, rows_of_points = make_find_stencils(basis, precision), position_access(precision).rows
    nodes_of_stencil, number, at_once = basis.width**2, PRECISIONS[precision], LANES_OF[precision]

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def p2g(  # type: ignore[no-untyped-def]
        storage, point_mass, stripe_starts, threads, nodes, nodes_y, ghosts, origin, cell_size
    ):
        rows, inverse_size = rows_of_points(storage), 1.0 / cell_size
        for parity in range(2):
            ranges = chunk_ranges((len(stripe_starts) - parity) // 2, threads)
            for thread in prange(threads_of(ranges)):
                per_point = np.empty((2, GROUP * COMPONENTS), number)
                weights = np.empty(nodes_of_stencil * GROUP, number)
                contributions = P2GContributions(np.empty(GROUP), weights, per_point[0], per_point[1])
                chunk = next_chunk(ranges, thread)
                while chunk >= 0:
                    begin, end = stripe_starts[2 * chunk + parity], stripe_starts[2 * chunk + parity + 1]
                    for start in range(begin, end, GROUP):
                        first, last = np.uint64(start), np.uint64(min(start + GROUP, end))
                        for p in range(first, last, at_once):
                            k = p - first
                            first_node, along_x, along_y = find_stencils(rows, p, nodes_y, ghosts, origin, inverse_size)
                            put(contributions.first_nodes, k, first_node)
                            put_weights(contributions.weights, k, along_x, along_y)
                            put_contributions(rows, p, k, point_mass, cell_size, along_x, along_y, contributions)
                        scatter(last - first, nodes, nodes_y, contributions)
                    chunk = next_chunk(ranges, thread)

    return p2g
