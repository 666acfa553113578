"""G2P: velocity, its gradient, the density around, and advection. Knows no law.

The moving-least-squares gradient of the grid's velocity at a point is L = sum_i w_i v_i (x_i - x_p)^T / D (Hu et al.
2018). On top of it the point keeps what the grid did not resolve of its velocity field v + A (x - x_p), for a time
constant tau:

    v <- sum_i w_i v_i^new + exp(-dt/tau) (v - sum_i w_i v_i^old)
    A <- L^new             + exp(-dt/tau) (A - L^old)

so that tau = 0 is APIC (Jiang et al. 2015), tau = infinity affine FLIP, and the loss per second does not depend on the
step. The energy of a point's field is m/2 (v^2 + A:A D); for tau = infinity the transfers keep its sum, but for terms
of the order of dt.

In some steps the grid also returns to each point pressure and density of the material around it, which couple the
volumes of points (`volume_coupling`).
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.materials.precision import PRECISIONS
from grainlaw.mpm_core.grid.grid import BULK, NEW_VX
from grainlaw.mpm_core.kernels.g2p_nodes import make_gather
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.simd.arithmetic import (
    filled_like,
    first_lanes,
    greater,
    largest,
    lesser,
    scaled_sum,
    smallest,
    total,
    widened,
)
from grainlaw.mpm_core.kernels.simd.registers import LANES, LANES_OF, put, several_at, transposed_at
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stencil import GROUP, make_find_stencils
from grainlaw.mpm_core.layout import (
    AXX,
    AXY,
    AYX,
    AYY,
    LXX,
    LXY,
    LYX,
    LYY,
    NEIGHBOUR_DENSITY,
    NEIGHBOUR_PRESSURE,
    VX,
    VY,
)
from grainlaw.mpm_core.parallel.blocks import points_of_block
from grainlaw.mpm_core.parallel.work_sharing import chunk_ranges, next_chunk, threads_of

# What `g2p` reports for each block of points.
KINETIC_ENERGY, LOWEST_X, HIGHEST_X, LOWEST_Y, HIGHEST_Y, MAX_SPEED, MOMENTUM_X, MOMENTUM_Y = range(8)
REPORTS = 8


class G2PStencils(NamedTuple):
    """How the points of a group interpolate; per axis, what belongs to one node for the whole group side by side.

    first_nodes           number of the first node
    weights_x, weights_y  w
    slopes_x, slopes_y    w (i - f)/(h moment) [1/m], of which the moving-least-squares gradient is made
    moment_x, moment_y    second moments of the weights, in cells squared
    """

    first_nodes: Any
    weights_x: Any
    weights_y: Any
    slopes_x: Any
    slopes_y: Any
    moment_x: Any
    moment_y: Any


class Interpolated(NamedTuple):
    """Four components of the nodes at the points of a group, those of each point side by side, and their gradients.

    The components are new and old velocity, or the bulk, without gradients: mass, pressure, density and nothing.
    """

    means: Any
    gradients_x: Any
    gradients_y: Any


class Sums(NamedTuple):
    """What is reported, over the points so far, in as many lanes as points are taken at once, as doubles."""

    twice_energy: Any
    advection_x: Any
    advection_y: Any
    fastest_squared: Any
    lowest_x: Any
    highest_x: Any
    lowest_y: Any
    highest_y: Any


@register_jitable(forceinline=True)
def no_sums(like):  # type: ignore[no-untyped-def]
    """The sums over no points, in lanes like others."""
    zero, infinite, negative = filled_like(0.0, like), filled_like(np.inf, like), filled_like(-np.inf, like)
    return Sums(zero, zero, zero, zero, infinite, negative, infinite, negative)


@register_jitable(forceinline=True)
def added_to_sums(sums, twice_energy, advection_x, advection_y, x, y, count, at_once):  # type: ignore[no-untyped-def]
    """The sums with some points more, of which only the first `count` exist."""
    lowest_x, lowest_y, highest_x, highest_y = x, y, x, y
    if count < at_once:
        twice_energy = first_lanes(twice_energy, count, 0.0)
        advection_x, advection_y = first_lanes(advection_x, count, 0.0), first_lanes(advection_y, count, 0.0)
        lowest_x, lowest_y = first_lanes(x, count, np.inf), first_lanes(y, count, np.inf)
        highest_x, highest_y = first_lanes(x, count, -np.inf), first_lanes(y, count, -np.inf)
    return Sums(
        sums.twice_energy + twice_energy,
        sums.advection_x + advection_x,
        sums.advection_y + advection_y,
        greater(sums.fastest_squared, advection_x * advection_x + advection_y * advection_y),
        lesser(sums.lowest_x, lowest_x),
        greater(sums.highest_x, highest_x),
        lesser(sums.lowest_y, lowest_y),
        greater(sums.highest_y, highest_y),
    )


@register_jitable(forceinline=True)
def report(reports, block, point_mass, sums):  # type: ignore[no-untyped-def]
    """Store the sums over a block."""
    reports[block, KINETIC_ENERGY] = 0.5 * point_mass * total(sums.twice_energy)
    reports[block, LOWEST_X], reports[block, HIGHEST_X] = smallest(sums.lowest_x), largest(sums.highest_x)
    reports[block, LOWEST_Y], reports[block, HIGHEST_Y] = smallest(sums.lowest_y), largest(sums.highest_y)
    reports[block, MAX_SPEED] = np.sqrt(largest(sums.fastest_squared))
    reports[block, MOMENTUM_X], reports[block, MOMENTUM_Y] = (
        point_mass * total(sums.advection_x),
        point_mass * total(sums.advection_y),
    )


@register_jitable(forceinline=True)
def updated_affine(affine, gradient, p, new, old, flip_fraction):  # type: ignore[no-untyped-def]
    """Store one component of L, and of A with what it remembers; returns the latter."""
    put(gradient, p, new)
    value = scaled_sum(flip_fraction, several_at(affine, p) - old, new)
    put(affine, p, value)
    return value


@register_jitable(forceinline=True)
def updated_gradients(rows, first, last, at_once, cell_size, flip_fraction, stencils, velocities, energies):  # type: ignore[no-untyped-def]
    """Update L and A of a group; `energies` receives A:A D of the points."""
    lxx, lxy, lyx, lyy = rows[LXX], rows[LXY], rows[LYX], rows[LYY]
    axx, axy, ayx, ayy = rows[AXX], rows[AXY], rows[AYX], rows[AYY]
    square = cell_size * cell_size
    for p in range(first, last, at_once):
        k = p - first
        new_xx, new_yx, old_xx, old_yx = transposed_at(velocities.gradients_x, k)
        new_xy, new_yy, old_xy, old_yy = transposed_at(velocities.gradients_y, k)
        xx = updated_affine(axx, lxx, p, new_xx, old_xx, flip_fraction)
        yx = updated_affine(ayx, lyx, p, new_yx, old_yx, flip_fraction)
        xy = updated_affine(axy, lxy, p, new_xy, old_xy, flip_fraction)
        yy = updated_affine(ayy, lyy, p, new_yy, old_yy, flip_fraction)
        along_x = (xx * xx + yx * yx) * several_at(stencils.moment_x, k)
        along_y = (xy * xy + yy * yy) * several_at(stencils.moment_y, k)
        put(energies, k, square * (along_x + along_y))


@register_jitable(forceinline=True)
def updated_neighbourhood(rows, first, last, at_once, bulk):  # type: ignore[no-untyped-def]
    """Update the averages of the material around a group."""
    for p in range(first, last, at_once):
        _, pressure, density, _ = transposed_at(bulk.means, p - first)
        put(rows[NEIGHBOUR_PRESSURE], p, pressure)
        put(rows[NEIGHBOUR_DENSITY], p, density)


@register_jitable(forceinline=True)
def advected(rows, first, last, at_once, dt, flip_fraction, velocities, energies, sums, position_at, put_position):  # type: ignore[no-untyped-def]
    """Update velocities and positions of a group; returns the sums with it."""
    vx, vy = rows[VX], rows[VY]
    for p in range(first, last, at_once):
        new_vx, new_vy, old_vx, old_vy = transposed_at(velocities.means, p - first)
        velocity_x = scaled_sum(flip_fraction, several_at(vx, p) - old_vx, new_vx)
        velocity_y = scaled_sum(flip_fraction, several_at(vy, p) - old_vy, new_vy)
        x, y = position_at(rows, p)
        advection_x, advection_y = widened(new_vx), widened(new_vy)
        new_x, new_y = scaled_sum(dt, advection_x, x), scaled_sum(dt, advection_y, y)
        put(vx, p, velocity_x)
        put(vy, p, velocity_y)
        put_position(rows, p, new_x, new_y)
        twice_energy = velocity_x * velocity_x + velocity_y * velocity_y + several_at(energies, p - first)
        count = float(last - p)
        sums = added_to_sums(sums, widened(twice_energy), advection_x, advection_y, new_x, new_y, count, at_once)
    return sums


def make_put_stencils(basis: Basis, precision: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Functions that allocate the stencils of a group, and store those of the points from p on that go at once."""
    width, find_stencils, number = basis.width, make_find_stencils(basis, precision), PRECISIONS[precision]

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def stencil_buffers():  # type: ignore[no-untyped-def]
        first_nodes, moments, per_node = (
            np.empty(GROUP),
            np.empty((2, GROUP), number),
            np.empty((4, width * GROUP), number),
        )
        return G2PStencils(first_nodes, per_node[0], per_node[1], per_node[2], per_node[3], moments[0], moments[1])

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def put_axis(k, axis, inverse_size, weights, slopes, moments):  # type: ignore[no-untyped-def]
        scale = inverse_size * axis.per_moment
        for a in range(width):
            put(weights, a * GROUP + k, axis.weights[a])
            put(slopes, a * GROUP + k, axis.weights[a] * (float(a) - axis.place) * scale)
        put(moments, k, axis.moment)

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def put_stencils(rows, p, k, nodes_y, ghosts, origin, inverse_size, stencils):  # type: ignore[no-untyped-def]
        first_nodes, weights_x, weights_y, slopes_x, slopes_y, moment_x, moment_y = stencils
        number, along_x, along_y = find_stencils(rows, p, nodes_y, ghosts, origin, inverse_size)
        put(first_nodes, k, number)
        put_axis(k, along_x, inverse_size, weights_x, slopes_x, moment_x)
        put_axis(k, along_y, inverse_size, weights_y, slopes_y, moment_y)

    return stencil_buffers, put_stencils


@cache
def make_g2p(basis: Basis, couples: bool, precision: str) -> Callable[..., Any]:
    """Give the points velocity, its gradient and, if `couples`, averages of the material around, and move them.

    `flip_fraction` is exp(-dt/tau). Reports per block of points: kinetic energy [J/m], corners of the bounding box [m],
    the largest speed at which a point moves [m/s] and the momentum of that motion [kg/s].
    """
    gather_velocities = make_gather(basis, NEW_VX, True, precision)
    gather_bulk = make_gather(basis, BULK, False, precision)
    stencil_buffers, put_stencils = make_put_stencils(basis, precision)
    rows_of_points, position_at, put_position, *_ = position_access(precision)
    number, at_once = PRECISIONS[precision], LANES_OF[precision]

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{couples:d}_{precision}_{CORE_MARK}")
    def g2p(  # type: ignore[no-untyped-def]
        storage, count, point_mass, nodes, nodes_y, ghosts, origin, cell_size, dt, flip_fraction, threads, reports
    ):
        rows, inverse_size = rows_of_points(storage), 1.0 / cell_size
        ranges = chunk_ranges(reports.shape[0], threads)
        for thread in prange(threads_of(ranges)):
            stencils, buffers = stencil_buffers(), np.empty((5, GROUP * LANES), number)
            velocities = Interpolated(buffers[0], buffers[1], buffers[2])
            bulk = Interpolated(buffers[3], buffers[1], buffers[2])
            energies = buffers[4]
            block = next_chunk(ranges, thread)
            while block >= 0:
                sums = no_sums(position_at(rows, np.uint64(0))[0])
                begin, end = points_of_block(block, reports.shape[0], count)
                for start in range(begin, end, GROUP):
                    first, last = np.uint64(start), np.uint64(min(start + GROUP, end))
                    for p in range(first, last, at_once):
                        put_stencils(rows, p, p - first, nodes_y, ghosts, origin, inverse_size, stencils)
                    gather_velocities(last - first, nodes, nodes_y, stencils, velocities)
                    updated_gradients(
                        rows, first, last, at_once, cell_size, flip_fraction, stencils, velocities, energies
                    )
                    if couples:
                        gather_bulk(last - first, nodes, nodes_y, stencils, bulk)
                        updated_neighbourhood(rows, first, last, at_once, bulk)
                    sums = advected(
                        rows,
                        first,
                        last,
                        at_once,
                        dt,
                        flip_fraction,
                        velocities,
                        energies,
                        sums,
                        position_at,
                        put_position,
                    )
                report(reports, block, point_mass, sums)
                block = next_chunk(ranges, thread)

    return g2p
