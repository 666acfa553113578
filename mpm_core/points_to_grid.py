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
from mpm_core.columns import AXX, AXY, AYX, AYY, DENSITY, SXX, SXY, SYY, SZZ, VX, VY
from mpm_core.grid import BULK, COMPONENTS
from mpm_core.quads import LANES, filled, put_quad, quad_at, scaled_sum
from mpm_core.sources import CORE_MARK
from mpm_core.stencils import GROUP, make_find_stencils, put_transposed


class Bringing(NamedTuple):
    """What the points of a group bring, and where.

    starts            number of the first node
    weights           w of each node, those of one node for the whole group side by side
    corners           momentum and force at the first node, before it is weighed; four components of each point
    steps_x, steps_y  what is added from node to node along x and y
    bulk              mass, volume and volume times pressure
    """

    starts: Any
    weights: Any
    corners: Any
    steps_x: Any
    steps_y: Any
    bulk: Any


@register_jitable(forceinline=True)
def room_for_bringing(nodes):  # type: ignore[no-untyped-def]
    """Room for what a group brings to stencils of so many nodes."""
    amounts = np.empty((4, GROUP * LANES))
    return Bringing(np.empty(GROUP), np.empty(nodes * GROUP), amounts[0], amounts[1], amounts[2], amounts[3])


@register_jitable(forceinline=True)
def put_amounts(rows, p, k, point_mass, cell_size, along_x, along_y, bringing):  # type: ignore[no-untyped-def]
    """Store what the four points from p on bring, from point k of a group on."""
    x, y = along_x.place, along_y.place
    affine = point_mass * cell_size
    volume = point_mass / quad_at(rows[DENSITY], p)
    scale = (-1.0 / cell_size) * volume
    scale_x, scale_y = scale * along_x.per_moment, scale * along_y.per_moment
    sxx, syy, sxy = quad_at(rows[SXX], p), quad_at(rows[SYY], p), quad_at(rows[SXY], p)
    px_x, py_x = affine * quad_at(rows[AXX], p), affine * quad_at(rows[AYX], p)
    px_y, py_y = affine * quad_at(rows[AXY], p), affine * quad_at(rows[AYY], p)
    fx_x, fy_x = scale_x * sxx, scale_x * sxy
    fx_y, fy_y = scale_y * sxy, scale_y * syy
    px = point_mass * quad_at(rows[VX], p) - (x * px_x + y * px_y)
    py = point_mass * quad_at(rows[VY], p) - (x * py_x + y * py_y)
    fx, fy = 0.0 - (x * fx_x + y * fx_y), 0.0 - (x * fy_x + y * fy_y)
    put_transposed(bringing.corners, k, px, py, fx, fy)
    put_transposed(bringing.steps_x, k, px_x, py_x, fx_x, fy_x)
    put_transposed(bringing.steps_y, k, px_y, py_y, fx_y, fy_y)
    pressure = (sxx + syy + quad_at(rows[SZZ], p)) * -THIRD
    put_transposed(bringing.bulk, k, filled(point_mass), volume, volume * pressure, filled(0.0))


@register_jitable(forceinline=True)
def brought_by(bringing, k):  # type: ignore[no-untyped-def]
    """What point k of a group brings to its first node, what is added along x and y, and its bulk."""
    at, (_, _, corners, steps_x, steps_y, bulk) = LANES * k, bringing
    return quad_at(corners, at), quad_at(steps_x, at), quad_at(steps_y, at), quad_at(bulk, at)


def make_scatter_one(basis: Basis) -> Callable[..., Any]:
    """A function that adds what a point brings to its nodes."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter_one(row, row_length, k, nodes, bringing):  # type: ignore[no-untyped-def]
        weights = bringing.weights
        at_row, step_x, step_y, carried = brought_by(bringing, k)
        for a in range(width):
            at_node = at_row
            for b in range(width):
                node = row + np.uint64(b * COMPONENTS)
                in_bulk = node + np.uint64(BULK)
                weight = weights[np.uint64((a * width + b) * GROUP) + k]
                put_quad(nodes, node, scaled_sum(weight, at_node, quad_at(nodes, node)))
                put_quad(nodes, in_bulk, scaled_sum(weight, carried, quad_at(nodes, in_bulk)))
                at_node = at_node + step_y
            at_row = at_row + step_x
            row += row_length

    return scatter_one


def make_scatter_two(basis: Basis) -> Callable[..., Any]:
    """A function that adds what a point and the next one bring to the nodes that they share."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter_two(row, row_length, k, nodes, bringing):  # type: ignore[no-untyped-def]
        weights, m = bringing.weights, k + np.uint64(1)
        at_row, step_x, step_y, carried = brought_by(bringing, k)
        at_row_2, step_x_2, step_y_2, carried_2 = brought_by(bringing, m)
        for a in range(width):
            at_node, at_node_2 = at_row, at_row_2
            for b in range(width):
                node, first = row + np.uint64(b * COMPONENTS), np.uint64((a * width + b) * GROUP)
                in_bulk = node + np.uint64(BULK)
                weight, weight_2 = weights[first + k], weights[first + m]
                with_first = scaled_sum(weight, at_node, quad_at(nodes, node))
                put_quad(nodes, node, scaled_sum(weight_2, at_node_2, with_first))
                with_first = scaled_sum(weight, carried, quad_at(nodes, in_bulk))
                put_quad(nodes, in_bulk, scaled_sum(weight_2, carried_2, with_first))
                at_node, at_node_2 = at_node + step_y, at_node_2 + step_y_2
            at_row, at_row_2 = at_row + step_x, at_row_2 + step_x_2
            row += row_length

    return scatter_two


def make_scatter(basis: Basis) -> Callable[..., Any]:
    """A function that adds what the points of a group bring to the grid."""
    scatter_one, scatter_two = make_scatter_one(basis), make_scatter_two(basis)

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter(count, nodes, nodes_y, bringing):  # type: ignore[no-untyped-def]
        starts, row_length = bringing.starts, np.uint64(nodes_y * COMPONENTS)
        k = np.uint64(0)
        while k < count:
            row = np.uint64(starts[k]) * np.uint64(COMPONENTS)
            if k + np.uint64(1) < count and starts[k + np.uint64(1)] == starts[k]:
                scatter_two(row, row_length, k, nodes, bringing)
                k += np.uint64(2)
            else:
                scatter_one(row, row_length, k, nodes, bringing)
                k += np.uint64(1)

    return scatter


def make_put_weights(basis: Basis) -> Callable[..., Any]:
    """A function that stores the weights of four points, from point k of a group on."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def put_weights(weights, k, along_x, along_y):  # type: ignore[no-untyped-def]
        for a in range(width):
            for b in range(width):
                put_quad(weights, (a * width + b) * GROUP + k, along_x.weights[a] * along_y.weights[b])

    return put_weights


@cache
def make_points_to_grid(basis: Basis) -> Callable[..., Any]:
    """Scatter mass, volume, pressure, momentum and internal force of the stripes of one parity to the grid."""
    scatter, put_weights, find_stencils = make_scatter(basis), make_put_weights(basis), make_find_stencils(basis)
    nodes_of_stencil = basis.width**2

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def points_to_grid(  # type: ignore[no-untyped-def]
        rows, point_mass, stripe_starts, shares, nodes, nodes_y, ghosts, origin, cell_size
    ):
        inverse_size = 1.0 / cell_size
        for share in prange(shares.shape[0] - 1):
            bringing = room_for_bringing(nodes_of_stencil)
            for stripe in range(shares[share], shares[share + 1], 2):
                for start in range(stripe_starts[stripe], stripe_starts[stripe + 1], GROUP):
                    first, last = np.uint64(start), np.uint64(min(start + GROUP, stripe_starts[stripe + 1]))
                    for p in range(first, last, LANES):
                        k = p - first
                        number, along_x, along_y = find_stencils(rows, p, nodes_y, ghosts, origin, inverse_size)
                        put_quad(bringing.starts, k, number)
                        put_weights(bringing.weights, k, along_x, along_y)
                        put_amounts(rows, p, k, point_mass, cell_size, along_x, along_y, bringing)
                    scatter(last - first, nodes, nodes_y, bringing)

    return points_to_grid
