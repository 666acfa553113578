"""From points to grid: what each point brings to the nodes of its stencil. Knows no law.

Affine particle-in-cell transfer (Jiang et al. 2015) with the moving-least-squares gradient (Hu et al. 2018): a point
brings the velocity field v + A (x - x_p) and the force of its stress,

    m_i += w_i m;  V_i += w_i V;  (V p)_i += w_i V p;
    (m v)_i += w_i m (v + A (x_i - x_p));  f_i -= w_i V sigma (x_i - x_p) / D.

Momentum and force are linear in the number of the node, `corner + a along_x + b along_y` for the node (a, b) of the
stencil, so that one addition leads from node to node. Neighbours in memory mostly share their stencil: two of them go
to it together, for the loads and stores of one.

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

from materials.compilation import named
from materials.tensor import THIRD
from mpm_core.basis import Basis
from mpm_core.columns import AXX, AXY, AYX, AYY, DENSITY, SXX, SXY, SYY, SZZ, VX, VY, X, Y
from mpm_core.grid import BULK, COMPONENTS
from mpm_core.quads import LANES, filled, put_quad, quad_at, scaled_sum
from mpm_core.sources import CORE_MARK
from mpm_core.stencils import GROUP, make_find_stencils, put_transposed


class Amounts(NamedTuple):
    """What the points of a group bring, four components of each point side by side.

    corners           momentum and force at the first node of the stencil, before it is weighed
    along_x, along_y  what is added from node to node
    bulk              mass, volume and volume times pressure
    """

    corners: Any
    along_x: Any
    along_y: Any
    bulk: Any


@register_jitable(forceinline=True)
def prepare_amounts(rows, first, last, point_mass, cell_size, stencils, amounts):  # type: ignore[no-untyped-def]
    """Fill the amounts of a group."""
    vx, vy, density = rows[VX], rows[VY], rows[DENSITY]
    axx, axy, ayx, ayy = rows[AXX], rows[AXY], rows[AYX], rows[AYY]
    sxx, syy, szz, sxy = rows[SXX], rows[SYY], rows[SZZ], rows[SXY]
    places_x, places_y, per_moment_x, per_moment_y = (
        stencils.x,
        stencils.y,
        stencils.per_moment_x,
        stencils.per_moment_y,
    )
    corners, along_x, along_y, bulk = amounts
    affine = point_mass * cell_size
    for p in range(first, last, LANES):
        k = p - first
        x, y = quad_at(places_x, k), quad_at(places_y, k)
        volume = point_mass / quad_at(density, p)
        scale = (-1.0 / cell_size) * volume
        scale_x, scale_y = scale * quad_at(per_moment_x, k), scale * quad_at(per_moment_y, k)
        px_x, py_x = affine * quad_at(axx, p), affine * quad_at(ayx, p)
        px_y, py_y = affine * quad_at(axy, p), affine * quad_at(ayy, p)
        fx_x, fy_x = scale_x * quad_at(sxx, p), scale_x * quad_at(sxy, p)
        fx_y, fy_y = scale_y * quad_at(sxy, p), scale_y * quad_at(syy, p)
        px = point_mass * quad_at(vx, p) - (x * px_x + y * px_y)
        py = point_mass * quad_at(vy, p) - (x * py_x + y * py_y)
        fx, fy = 0.0 - (x * fx_x + y * fx_y), 0.0 - (x * fy_x + y * fy_y)
        put_transposed(corners, k, px, py, fx, fy)
        put_transposed(along_x, k, px_x, py_x, fx_x, fy_x)
        put_transposed(along_y, k, px_y, py_y, fx_y, fy_y)
        pressure = (quad_at(sxx, p) + quad_at(syy, p) + quad_at(szz, p)) * -THIRD
        put_transposed(bulk, k, filled(point_mass), volume, volume * pressure, filled(0.0))


@register_jitable(forceinline=True)
def brought_by(amounts, k):  # type: ignore[no-untyped-def]
    """What point k of a group brings to its first node, what is added along x and y, and its bulk."""
    corners, along_x, along_y, bulk = amounts
    at = LANES * k
    return quad_at(corners, at), quad_at(along_x, at), quad_at(along_y, at), quad_at(bulk, at)


def make_scatter_one(basis: Basis) -> Callable[..., Any]:
    """A function that adds what a point brings to its nodes."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter_one(row, row_length, k, nodes, stencils, amounts):  # type: ignore[no-untyped-def]
        weights_x, weights_y = stencils.weights_x, stencils.weights_y
        at_row, step_x, step_y, carried = brought_by(amounts, k)
        for a in range(width):
            weight_x = weights_x[np.uint64(a * GROUP) + k]
            at_node, step, shared = weight_x * at_row, weight_x * step_y, weight_x * carried
            for b in range(width):
                node = row + np.uint64(b * COMPONENTS)
                in_bulk = node + np.uint64(BULK)
                weight = weights_y[np.uint64(b * GROUP) + k]
                put_quad(nodes, node, scaled_sum(weight, at_node, quad_at(nodes, node)))
                put_quad(nodes, in_bulk, scaled_sum(weight, shared, quad_at(nodes, in_bulk)))
                at_node = at_node + step
            at_row = at_row + step_x
            row += row_length

    return scatter_one


def make_scatter_two(basis: Basis) -> Callable[..., Any]:
    """A function that adds what a point and the next one bring to the nodes that they share."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter_two(row, row_length, k, nodes, stencils, amounts):  # type: ignore[no-untyped-def]
        weights_x, weights_y = stencils.weights_x, stencils.weights_y
        m = k + np.uint64(1)
        at_row, step_x, step_y, carried = brought_by(amounts, k)
        at_row_2, step_x_2, step_y_2, carried_2 = brought_by(amounts, m)
        for a in range(width):
            weight, weight_2 = weights_x[np.uint64(a * GROUP) + k], weights_x[np.uint64(a * GROUP) + m]
            at_node, step, shared = weight * at_row, weight * step_y, weight * carried
            at_node_2, step_2, shared_2 = weight_2 * at_row_2, weight_2 * step_y_2, weight_2 * carried_2
            for b in range(width):
                node = row + np.uint64(b * COMPONENTS)
                in_bulk = node + np.uint64(BULK)
                weight, weight_2 = weights_y[np.uint64(b * GROUP) + k], weights_y[np.uint64(b * GROUP) + m]
                with_first = scaled_sum(weight, at_node, quad_at(nodes, node))
                put_quad(nodes, node, scaled_sum(weight_2, at_node_2, with_first))
                with_first = scaled_sum(weight, shared, quad_at(nodes, in_bulk))
                put_quad(nodes, in_bulk, scaled_sum(weight_2, shared_2, with_first))
                at_node, at_node_2 = at_node + step, at_node_2 + step_2
            at_row, at_row_2 = at_row + step_x, at_row_2 + step_x_2
            row += row_length

    return scatter_two


def make_scatter(basis: Basis) -> Callable[..., Any]:
    """A function that adds what the points of a group bring to the grid."""
    scatter_one, scatter_two = make_scatter_one(basis), make_scatter_two(basis)

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter(count, nodes, nodes_y, stencils, amounts):  # type: ignore[no-untyped-def]
        starts, row_length = stencils.starts, np.uint64(nodes_y * COMPONENTS)
        k = np.uint64(0)
        while k < count:
            row = np.uint64(starts[k]) * np.uint64(COMPONENTS)
            if k + np.uint64(1) < count and starts[k + np.uint64(1)] == starts[k]:
                scatter_two(row, row_length, k, nodes, stencils, amounts)
                k += np.uint64(2)
            else:
                scatter_one(row, row_length, k, nodes, stencils, amounts)
                k += np.uint64(1)

    return scatter


@cache
def make_points_to_grid(basis: Basis) -> Callable[..., Any]:
    """Scatter mass, volume, pressure, momentum and internal force of the stripes of one parity to the grid."""
    scatter = make_scatter(basis)
    room_for_stencils, find_stencils = make_find_stencils(basis, receive=False)

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def points_to_grid(  # type: ignore[no-untyped-def]
        rows, point_mass, stripe_starts, chunks, parity, nodes, nodes_y, ghosts, origin, cell_size
    ):
        for chunk in prange(chunks.shape[0] - 1):
            stencils, room = room_for_stencils(), np.empty((4, GROUP * LANES))
            amounts = Amounts(room[0], room[1], room[2], room[3])
            for stripe in range(chunks[chunk] + (chunks[chunk] + parity) % 2, chunks[chunk + 1], 2):
                for start in range(stripe_starts[stripe], stripe_starts[stripe + 1], GROUP):
                    first, last = np.uint64(start), np.uint64(min(start + GROUP, stripe_starts[stripe + 1]))
                    find_stencils(rows[X], rows[Y], first, last, nodes_y, ghosts, origin, cell_size, stencils)
                    prepare_amounts(rows, first, last, point_mass, cell_size, stencils, amounts)
                    scatter(last - first, nodes, nodes_y, stencils, amounts)

    return points_to_grid
