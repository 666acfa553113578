"""G2P: velocity, its gradient, the density around, and advection. Knows no law.

The moving-least-squares gradient of the grid's velocity at a point is L = sum_i w_i v_i (x_i - x_p)^T / D (Hu et al.
2018). On top of it the point keeps what the grid did not resolve of its velocity field v + A (x - x_p), for a time
constant tau:

    v <- sum_i w_i v_i^new + exp(-dt/tau) (v - sum_i w_i v_i^old)
    A <- L^new             + exp(-dt/tau) (A - L^old)

so that tau = 0 is APIC (Jiang et al. 2015), tau = infinity affine FLIP, and the loss per second does not depend on the
step. The energy of a point's field is m/2 (v^2 + A:A D); for tau = infinity the transfers keep its sum, but for terms
of the order of dt.

In axisymmetry the material is stretched around the axis besides, by L_zz = v_r^new/r (for r see
`SMALLEST_RADIUS`).

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
from grainlaw.mpm_core.grid.grid import NODE_OF
from grainlaw.mpm_core.kernels.g2p_nodes import make_gather
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.shape_functions import SMALLEST_RADIUS, Basis
from grainlaw.mpm_core.kernels.simd.arithmetic import (
    filled_like,
    first_lanes,
    greater,
    largest,
    lesser,
    rounding_to,
    scaled_sum,
    smallest,
    total,
    widened,
)
from grainlaw.mpm_core.kernels.simd.registers import LANES, LANES_OF, put, several_at, transposed_at
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stencil import GROUP, make_find_stencils
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.parallel.blocks import points_of_block
from grainlaw.mpm_core.parallel.work_sharing import chunk_ranges, next_chunk, threads_of
from grainlaw.mpm_core.space import Space

# What a G2P reports for each block of points; behind that, for each axis: lowest and highest coordinate, momentum.
KINETIC_ENERGY, MAX_SPEED, OF_AXES = range(3)
LOWEST, HIGHEST, MOMENTUM, PER_AXIS = range(4)


def reports_of(space: Space) -> int:
    """How many numbers are reported for each block of points."""
    return OF_AXES + PER_AXIS * space.axes


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
    """What is reported, over the points so far, in as many lanes as points are taken at once, as doubles.

    Energy and momentum are per mass, but where each point has a mass of its own.
    """

    twice_energy: Any
    momentum_x: Any
    momentum_y: Any
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
def added_to_sums(sums, mass, twice_energy, advection_x, advection_y, x, y, count, at_once):  # type: ignore[no-untyped-def]
    """The sums with some points more, of which only the first `count` exist; `mass` may be the number one."""
    lowest_x, lowest_y, highest_x, highest_y = x, y, x, y
    if count < at_once:
        twice_energy = first_lanes(twice_energy, count, 0.0)
        advection_x, advection_y = first_lanes(advection_x, count, 0.0), first_lanes(advection_y, count, 0.0)
        lowest_x, lowest_y = first_lanes(x, count, np.inf), first_lanes(y, count, np.inf)
        highest_x, highest_y = first_lanes(x, count, -np.inf), first_lanes(y, count, -np.inf)
    return Sums(
        sums.twice_energy + mass * twice_energy,
        sums.momentum_x + mass * advection_x,
        sums.momentum_y + mass * advection_y,
        greater(sums.fastest_squared, advection_x * advection_x + advection_y * advection_y),
        lesser(sums.lowest_x, lowest_x),
        greater(sums.highest_x, highest_x),
        lesser(sums.lowest_y, lowest_y),
        greater(sums.highest_y, highest_y),
    )


@register_jitable(forceinline=True)
def report(reports, block, point_mass, sums):  # type: ignore[no-untyped-def]
    """Store the sums over a block."""
    of_x, of_y = OF_AXES, OF_AXES + PER_AXIS
    reports[block, KINETIC_ENERGY] = 0.5 * point_mass * total(sums.twice_energy)
    reports[block, MAX_SPEED] = np.sqrt(largest(sums.fastest_squared))
    reports[block, of_x + LOWEST], reports[block, of_x + HIGHEST] = smallest(sums.lowest_x), largest(sums.highest_x)
    reports[block, of_y + LOWEST], reports[block, of_y + HIGHEST] = smallest(sums.lowest_y), largest(sums.highest_y)
    reports[block, of_x + MOMENTUM] = point_mass * total(sums.momentum_x)
    reports[block, of_y + MOMENTUM] = point_mass * total(sums.momentum_y)


@register_jitable(forceinline=True)
def updated_affine(affine, gradient, p, new, old, flip_fraction):  # type: ignore[no-untyped-def]
    """Store one component of L, and of A with what it remembers; returns the latter."""
    put(gradient, p, new)
    value = scaled_sum(flip_fraction, several_at(affine, p) - old, new)
    put(affine, p, value)
    return value


def make_update_gradients(space: Space, precision: str) -> Callable[..., Any]:
    """A function that updates L and A of a group; `energies` receives A:A D of the points."""
    layout = layout_of(space)
    lxx, lxy, lyx, lyy = range(layout.gradient, layout.gradient + 4)
    axx, axy, ayx, ayy = range(layout.affine, layout.affine + 4)

    @register_jitable(forceinline=True)
    @named(f"{space.name}_{precision}_{CORE_MARK}")
    def update_gradients(rows, first, last, at_once, cell_size, flip_fraction, stencils, velocities, energies):  # type: ignore[no-untyped-def]
        square = cell_size * cell_size
        for p in range(first, last, at_once):
            k = p - first
            new_xx, new_yx, old_xx, old_yx = transposed_at(velocities.gradients_x, k)
            new_xy, new_yy, old_xy, old_yy = transposed_at(velocities.gradients_y, k)
            xx = updated_affine(rows[axx], rows[lxx], p, new_xx, old_xx, flip_fraction)
            yx = updated_affine(rows[ayx], rows[lyx], p, new_yx, old_yx, flip_fraction)
            xy = updated_affine(rows[axy], rows[lxy], p, new_xy, old_xy, flip_fraction)
            yy = updated_affine(rows[ayy], rows[lyy], p, new_yy, old_yy, flip_fraction)
            along_x = (xx * xx + yx * yx) * several_at(stencils.moment_x, k)
            along_y = (xy * xy + yy * yy) * several_at(stencils.moment_y, k)
            put(energies, k, square * (along_x + along_y))

    return update_gradients


def make_update_neighbourhood(space: Space, precision: str) -> Callable[..., Any]:
    """A function that updates the averages of the material around a group."""
    layout = layout_of(space)
    neighbour_pressure, neighbour_density = layout.neighbour_pressure, layout.neighbour_density

    @register_jitable(forceinline=True)
    @named(f"{space.name}_{precision}_{CORE_MARK}")
    def update_neighbourhood(rows, first, last, at_once, bulk):  # type: ignore[no-untyped-def]
        for p in range(first, last, at_once):
            _, pressure, density, _ = transposed_at(bulk.means, p - first)
            put(rows[neighbour_pressure], p, pressure)
            put(rows[neighbour_density], p, density)

    return update_neighbourhood


def make_advect(space: Space, precision: str) -> Callable[..., Any]:
    """A function that updates velocities and positions of a group; it returns the sums with it."""
    layout, access = layout_of(space), position_access(space, precision)
    position_at, put_position, rounded = access.at, access.put, rounding_to(precision)
    vx_row, vy_row, mass_row, hoop_gradient, hoop = (
        *(layout.velocity, layout.velocity + 1, layout.mass, layout.hoop_gradient),
        space.hoop,
    )

    @register_jitable(forceinline=True)
    @named(f"{space.name}_{precision}_{CORE_MARK}")
    def advect(rows, first, last, at_once, cell_size, dt, flip_fraction, velocities, energies, sums):  # type: ignore[no-untyped-def]
        vx, vy = rows[vx_row], rows[vy_row]
        for p in range(first, last, at_once):
            new_vx, new_vy, old_vx, old_vy = transposed_at(velocities.means, p - first)
            velocity_x = scaled_sum(flip_fraction, several_at(vx, p) - old_vx, new_vx)
            velocity_y = scaled_sum(flip_fraction, several_at(vy, p) - old_vy, new_vy)
            x, y = position_at(rows, p)
            if hoop:
                put(rows[hoop_gradient], p, new_vx / greater(rounded(x), SMALLEST_RADIUS * cell_size))
            advection_x, advection_y = widened(new_vx), widened(new_vy)
            new_x, new_y = scaled_sum(dt, advection_x, x), scaled_sum(dt, advection_y, y)
            put(vx, p, velocity_x)
            put(vy, p, velocity_y)
            put_position(rows, p, (new_x, new_y))
            twice_energy = velocity_x * velocity_x + velocity_y * velocity_y + several_at(energies, p - first)
            mass = widened(several_at(rows[mass_row], p)) if hoop else 1.0
            count = float(last - p)
            sums = added_to_sums(
                sums, mass, widened(twice_energy), advection_x, advection_y, new_x, new_y, count, at_once
            )
        return sums

    return advect


def make_put_stencils(space: Space, basis: Basis, precision: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Functions that allocate the stencils of a group, and store those of the points from p on that go at once."""
    find_stencils = make_find_stencils(space, basis, precision)
    width, number, mark = basis.width, PRECISIONS[precision], f"{space.name}_{basis.name}_{precision}_{CORE_MARK}"

    @register_jitable(forceinline=True)
    @named(mark)
    def stencil_buffers():  # type: ignore[no-untyped-def]
        first_nodes, moments, per_node = (
            np.empty(GROUP),
            np.empty((2, GROUP), number),
            np.empty((4, width * GROUP), number),
        )
        return G2PStencils(first_nodes, per_node[0], per_node[1], per_node[2], per_node[3], moments[0], moments[1])

    @register_jitable(forceinline=True)
    @named(mark)
    def put_axis(k, axis, inverse_size, weights, slopes, moments):  # type: ignore[no-untyped-def]
        scale = inverse_size * axis.per_moment
        for a in range(width):
            put(weights, a * GROUP + k, axis.weights[a])
            put(slopes, a * GROUP + k, axis.weights[a] * (float(a) - axis.place) * scale)
        put(moments, k, axis.moment)

    @register_jitable(forceinline=True)
    @named(mark)
    def put_stencils(rows, p, k, strides, ghosts, origin, inverse_size, stencils):  # type: ignore[no-untyped-def]
        first_nodes, weights_x, weights_y, slopes_x, slopes_y, moment_x, moment_y = stencils
        number, along_x, along_y = find_stencils(rows, p, strides, ghosts, origin, inverse_size)
        put(first_nodes, k, number)
        put_axis(k, along_x, inverse_size, weights_x, slopes_x, moment_x)
        put_axis(k, along_y, inverse_size, weights_y, slopes_y, moment_y)

    return stencil_buffers, put_stencils


@cache
def make_g2p(space: Space, basis: Basis, couples: bool, precision: str) -> Callable[..., Any]:
    """Give the points velocity, its gradient and, if `couples`, averages of the material around, and move them.

    `flip_fraction` is exp(-dt/tau), `strides` are those of the grid. Reports per block of points: kinetic energy, the
    largest speed at which a point moves [m/s], the corners of the bounding box [m] and the momentum of that motion.
    """
    gather_velocities = make_gather(basis, NODE_OF[2].momentum, True, precision)
    gather_bulk = make_gather(basis, NODE_OF[2].mass, False, precision)
    stencil_buffers, put_stencils = make_put_stencils(space, basis, precision)
    update_gradients, advect = make_update_gradients(space, precision), make_advect(space, precision)
    update_neighbourhood = make_update_neighbourhood(space, precision)
    rows_of_points, position_at, *_ = position_access(space, precision)
    number, at_once = PRECISIONS[precision], LANES_OF[precision]

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{space.name}_{basis.name}_{couples:d}_{precision}_{CORE_MARK}")
    def g2p(  # type: ignore[no-untyped-def]
        storage, count, point_mass, nodes, strides, ghosts, origin, cell_size, dt, flip_fraction, threads, reports
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
                        put_stencils(rows, p, p - first, strides, ghosts, origin, inverse_size, stencils)
                    gather_velocities(last - first, nodes, strides[0], stencils, velocities)
                    update_gradients(
                        rows, first, last, at_once, cell_size, flip_fraction, stencils, velocities, energies
                    )
                    if couples:
                        gather_bulk(last - first, nodes, strides[0], stencils, bulk)
                        update_neighbourhood(rows, first, last, at_once, bulk)
                    sums = advect(rows, first, last, at_once, cell_size, dt, flip_fraction, velocities, energies, sums)
                report(reports, block, point_mass, sums)
                block = next_chunk(ranges, thread)

    return g2p
