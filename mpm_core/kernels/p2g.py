"""P2G: what each point brings to the nodes of its stencil. Knows no law.

Affine particle-in-cell transfer (Jiang et al. 2015) with the moving-least-squares gradient (Hu et al. 2018): a point
brings the velocity field v + A (x - x_p) and the force of its stress,

    m_i += w_i m;  V_i += w_i V;  (V p)_i += w_i V p;
    (m v)_i += w_i m (v + A (x_i - x_p));  f_i -= w_i V sigma (x_i - x_p) / D.

In axisymmetry m and V are per radian, and the stress around the axis pulls inwards besides, f_r,i -= w_i V sigma_zz/r
(for r see `SMALLEST_RADIUS`).

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
from grainlaw.mpm_core.kernels.shape_functions import SMALLEST_RADIUS, Basis
from grainlaw.mpm_core.kernels.simd.arithmetic import as_lanes, filled_like, greater, rounding_to, scaled_sum
from grainlaw.mpm_core.kernels.simd.registers import LANES_OF, put, put_transposed, several_at
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stencil import GROUP, make_find_stencils
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.parallel.work_sharing import chunk_ranges, next_chunk, threads_of
from grainlaw.mpm_core.space import Space


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


def make_put_contributions(space: Space, precision: str) -> Callable[..., Any]:
    """A function that stores what points contribute, as many as are taken at once, from point k of a group on."""
    layout, position_at = layout_of(space), position_access(space, precision).at
    vx, vy = layout.velocity, layout.velocity + 1
    axx, axy, ayx, ayy = range(layout.affine, layout.affine + 4)
    sxx, syy, szz, sxy = range(layout.stress, layout.stress + 4)
    density, mass_row, hoop, rounded = layout.density, layout.mass, space.hoop, rounding_to(precision)

    @register_jitable(forceinline=True)
    @named(f"{space.name}_{precision}_{CORE_MARK}")
    def put_contributions(rows, p, k, point_mass, cell_size, along_x, along_y, contributions):  # type: ignore[no-untyped-def]
        # to the first node
        x, y = 0.0 - along_x.place, 0.0 - along_y.place
        mass = several_at(rows[mass_row], p) if hoop else point_mass
        affine = mass * cell_size
        volume = mass / several_at(rows[density], p)
        scale = (-1.0 / cell_size) * volume
        scale_x, scale_y = scale * along_x.per_moment, scale * along_y.per_moment
        xx, yy, xy = several_at(rows[sxx], p), several_at(rows[syy], p), several_at(rows[sxy], p)
        px_x, py_x = affine * several_at(rows[axx], p), affine * several_at(rows[ayx], p)
        px_y, py_y = affine * several_at(rows[axy], p), affine * several_at(rows[ayy], p)
        fx_x, fy_x = scale_x * xx, scale_x * xy
        fx_y, fy_y = scale_y * xy, scale_y * yy
        px = scaled_sum(x, px_x, scaled_sum(y, px_y, mass * several_at(rows[vx], p)))
        py = scaled_sum(x, py_x, scaled_sum(y, py_y, mass * several_at(rows[vy], p)))
        fx, fy = scaled_sum(x, fx_x, y * fx_y), scaled_sum(x, fy_x, y * fy_y)
        if hoop:
            radius = greater(rounded(position_at(rows, p)[0]), SMALLEST_RADIUS * cell_size)
            fx = fx - volume * several_at(rows[szz], p) / radius
        pressure = (xx + yy + several_at(rows[szz], p)) * -THIRD
        bulk = as_lanes(mass, volume), volume, volume * pressure, filled_like(0.0, volume)
        put_transposed(contributions.values, k, (px, py, fx, fy, *bulk))
        put_transposed(contributions.increments, k, (px_x, py_x, fx_x, fy_x, px_y, py_y, fx_y, fy_y))

    return put_contributions


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
def make_p2g(space: Space, basis: Basis, precision: str) -> Callable[..., Any]:
    """Scatter mass, volume, pressure, momentum and internal force to the grid; the precision is that of both.

    `point_mass` is the mass of each point; points have their own in axisymmetry. `strides` are those of the grid.
    """
    put_contributions, put_weights = make_put_contributions(space, precision), make_put_weights(basis)
    find_stencils, rows_of_points = make_find_stencils(space, basis, precision), position_access(space, precision).rows
    nodes_of_stencil, number, at_once = basis.width**2, PRECISIONS[precision], LANES_OF[precision]
    scatter = make_scatter(basis)

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{space.name}_{basis.name}_{precision}_{CORE_MARK}")
    def p2g(  # type: ignore[no-untyped-def]
        storage, point_mass, stripe_starts, threads, nodes, strides, ghosts, origin, cell_size
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
                            first_node, along_x, along_y = find_stencils(rows, p, strides, ghosts, origin, inverse_size)
                            put(contributions.first_nodes, k, first_node)
                            put_weights(contributions.weights, k, along_x, along_y)
                            put_contributions(rows, p, k, point_mass, cell_size, along_x, along_y, contributions)
                        scatter(last - first, nodes, strides[0], contributions)
                    chunk = next_chunk(ranges, thread)

    return p2g
