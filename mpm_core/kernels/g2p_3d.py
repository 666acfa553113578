"""G2P in three dimensions: the equations of `g2p`, without what couples volumes, which `bulk_3d` returns."""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.materials.precision import PRECISIONS
from grainlaw.mpm_core.grid.grid import COMPONENTS
from grainlaw.mpm_core.kernels.g2p import (
    HIGHEST,
    KINETIC_ENERGY,
    LOWEST,
    MAX_SPEED,
    MOMENTUM,
    OF_AXES,
    PER_AXIS,
    updated_affine,
)
from grainlaw.mpm_core.kernels.g2p_nodes_3d import Interpolated3D, make_gather_3d, middle_of
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
from grainlaw.mpm_core.kernels.simd.registers import LANES_OF, half_transposed_at, put, several_at
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stencil import GROUP_3D, make_find_stencils
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.parallel.blocks import points_of_block
from grainlaw.mpm_core.parallel.work_sharing import chunk_ranges, next_chunk, threads_of
from grainlaw.mpm_core.space import THREE_D

_LAYOUT = layout_of(THREE_D)
_VX, _VY, _VZ = range(_LAYOUT.velocity, _LAYOUT.velocity + 3)
# Halves of a node after the momentum update.
_NEW, _OLD = 0, 1


class G2PStencils3D(NamedTuple):
    """How the points of a group interpolate; a tuple over the axes of what each axis has.

    first_nodes  number of the first node of each point
    weights      w, those of one node for the whole group side by side
    places       distance from the middle node of the stencil, in cells
    scales       1/(h moment) [1/m]
    moments      second moment of the weights, in cells squared
    """

    first_nodes: Any
    weights: Any
    places: Any
    scales: Any
    moments: Any


class Sums3D(NamedTuple):
    """What is reported, over the points so far, in as many lanes as points are taken at once, as doubles.

    Energy and momentum are per mass; momentum and coordinates are tuples over the axes.
    """

    twice_energy: Any
    fastest_squared: Any
    momentum: Any
    lowest: Any
    highest: Any


@register_jitable(forceinline=True)
def no_sums_3d(like):  # type: ignore[no-untyped-def]
    """The sums over no points, in lanes like others."""
    zero, infinite, negative = filled_like(0.0, like), filled_like(np.inf, like), filled_like(-np.inf, like)
    return Sums3D(zero, zero, (zero, zero, zero), (infinite, infinite, infinite), (negative, negative, negative))


@register_jitable(forceinline=True)
def first_of_three(lanes, count, otherwise):  # type: ignore[no-untyped-def]
    """The first lanes of three, and another number in the rest of each."""
    x, y, z = lanes
    return first_lanes(x, count, otherwise), first_lanes(y, count, otherwise), first_lanes(z, count, otherwise)


@register_jitable(forceinline=True)
def added_to_sums_3d(sums, twice_energy, advection, position, count, at_once):  # type: ignore[no-untyped-def]
    """The sums with some points more, of which only the first `count` exist."""
    lowest, highest = position, position
    if count < at_once:
        twice_energy, advection = first_lanes(twice_energy, count, 0.0), first_of_three(advection, count, 0.0)
        lowest, highest = first_of_three(position, count, np.inf), first_of_three(position, count, -np.inf)
    (x, y, z), (low_x, low_y, low_z), (high_x, high_y, high_z) = advection, sums.lowest, sums.highest
    return Sums3D(
        sums.twice_energy + twice_energy,
        greater(sums.fastest_squared, x * x + y * y + z * z),
        (sums.momentum[0] + x, sums.momentum[1] + y, sums.momentum[2] + z),
        (lesser(low_x, lowest[0]), lesser(low_y, lowest[1]), lesser(low_z, lowest[2])),
        (greater(high_x, highest[0]), greater(high_y, highest[1]), greater(high_z, highest[2])),
    )


@register_jitable(forceinline=True)
def report_3d(reports, block, point_mass, sums):  # type: ignore[no-untyped-def]
    """Store the sums over a block."""
    reports[block, KINETIC_ENERGY] = 0.5 * point_mass * total(sums.twice_energy)
    reports[block, MAX_SPEED] = np.sqrt(largest(sums.fastest_squared))
    for axis in range(3):
        of_axis = OF_AXES + PER_AXIS * axis
        reports[block, of_axis + LOWEST] = smallest(sums.lowest[axis])
        reports[block, of_axis + HIGHEST] = largest(sums.highest[axis])
        reports[block, of_axis + MOMENTUM] = point_mass * total(sums.momentum[axis])


def make_update_column(axis: int) -> Callable[..., Any]:
    """A function that updates the derivatives along an axis in L and A of points; returns their part of A:A D.

    The derivative of what was interpolated is (first moment - place mean)/(h moment).
    """
    lx, ly, lz = (_LAYOUT.gradient + 3 * component + axis for component in range(3))
    ax, ay, az = (_LAYOUT.affine + 3 * component + axis for component in range(3))

    @register_jitable(forceinline=True)
    @named(f"{axis}_{CORE_MARK}")
    def update_column(rows, p, k, flip_fraction, new, old, moments, stencils):  # type: ignore[no-untyped-def]
        new_x, new_y, new_z, _ = half_transposed_at(moments, k, _NEW)
        old_x, old_y, old_z, _ = half_transposed_at(moments, k, _OLD)
        place, scale = several_at(stencils.places[axis], k), several_at(stencils.scales[axis], k)
        new_x, old_x = scale * (new_x - place * new[0]), scale * (old_x - place * old[0])
        new_y, old_y = scale * (new_y - place * new[1]), scale * (old_y - place * old[1])
        new_z, old_z = scale * (new_z - place * new[2]), scale * (old_z - place * old[2])
        x = updated_affine(rows[ax], rows[lx], p, new_x, old_x, flip_fraction)
        y = updated_affine(rows[ay], rows[ly], p, new_y, old_y, flip_fraction)
        z = updated_affine(rows[az], rows[lz], p, new_z, old_z, flip_fraction)
        return (x * x + y * y + z * z) * several_at(stencils.moments[axis], k)

    return update_column


update_column_x, update_column_y, update_column_z = map(make_update_column, range(3))


def make_advect_3d(precision: str) -> Callable[..., Any]:
    """A function that updates velocities, gradients and positions of a group; it returns the sums with it."""
    access, at_once = position_access(THREE_D, precision), LANES_OF[precision]
    position_at, put_position = access.at, access.put

    @register_jitable(forceinline=True)
    @named(f"{precision}_{CORE_MARK}")
    def advect_3d(rows, first, last, dt, flip_fraction, cell_size, stencils, interpolated, sums):  # type: ignore[no-untyped-def]
        square = cell_size * cell_size
        for p in range(first, last, at_once):
            k = p - first
            new_x, new_y, new_z, _ = half_transposed_at(interpolated.means, k, _NEW)
            old_x, old_y, old_z, _ = half_transposed_at(interpolated.means, k, _OLD)
            new, old = (new_x, new_y, new_z), (old_x, old_y, old_z)
            in_x = update_column_x(rows, p, k, flip_fraction, new, old, interpolated.moments_x, stencils)
            in_y = update_column_y(rows, p, k, flip_fraction, new, old, interpolated.moments_y, stencils)
            in_z = update_column_z(rows, p, k, flip_fraction, new, old, interpolated.moments_z, stencils)
            vx = scaled_sum(flip_fraction, several_at(rows[_VX], p) - old_x, new_x)
            vy = scaled_sum(flip_fraction, several_at(rows[_VY], p) - old_y, new_y)
            vz = scaled_sum(flip_fraction, several_at(rows[_VZ], p) - old_z, new_z)
            put(rows[_VX], p, vx)
            put(rows[_VY], p, vy)
            put(rows[_VZ], p, vz)
            x, y, z = position_at(rows, p)
            by_x, by_y, by_z = widened(new_x), widened(new_y), widened(new_z)
            position = scaled_sum(dt, by_x, x), scaled_sum(dt, by_y, y), scaled_sum(dt, by_z, z)
            put_position(rows, p, position)
            twice_energy = vx * vx + vy * vy + vz * vz + square * (in_x + in_y + in_z)
            advection, count = (by_x, by_y, by_z), float(last - p)
            sums = added_to_sums_3d(sums, widened(twice_energy), advection, position, count, at_once)
        return sums

    return advect_3d


def make_put_stencils_3d(basis: Basis, precision: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Functions that allocate the stencils of a group, and store those of the points from p on that go at once."""
    find_stencils, middle = make_find_stencils(THREE_D, basis, precision), float(middle_of(basis))
    width, number, mark = basis.width, PRECISIONS[precision], f"{basis.name}_{precision}_{CORE_MARK}"

    @register_jitable(forceinline=True)
    @named(mark)
    def stencil_buffers_3d():  # type: ignore[no-untyped-def]
        w, a = np.empty((3, width * GROUP_3D), number), np.empty((9, GROUP_3D), number)
        per_axis = (a[0], a[1], a[2]), (a[3], a[4], a[5]), (a[6], a[7], a[8])
        return G2PStencils3D(np.empty(GROUP_3D), (w[0], w[1], w[2]), per_axis[0], per_axis[1], per_axis[2])

    @register_jitable(forceinline=True)
    @named(mark)
    def put_axis_3d(k, axis, inverse_size, weights, places, scales, moments):  # type: ignore[no-untyped-def]
        for a in range(width):
            put(weights, a * GROUP_3D + k, axis.weights[a])
        put(places, k, axis.place - middle)
        put(scales, k, inverse_size * axis.per_moment)
        put(moments, k, axis.moment)

    @register_jitable(forceinline=True)
    @named(mark)
    def put_stencils_3d(rows, p, k, strides, ghosts, origin, inverse_size, stencils):  # type: ignore[no-untyped-def]
        first_nodes, weights, places, scales, moments = stencils
        node, x, y, z = find_stencils(rows, p, strides, ghosts, origin, inverse_size)
        put(first_nodes, k, node)
        put_axis_3d(k, x, inverse_size, weights[0], places[0], scales[0], moments[0])
        put_axis_3d(k, y, inverse_size, weights[1], places[1], scales[1], moments[1])
        put_axis_3d(k, z, inverse_size, weights[2], places[2], scales[2], moments[2])

    return stencil_buffers_3d, put_stencils_3d


@cache
def make_g2p_3d(basis: Basis, precision: str) -> Callable[..., Any]:
    """Give the points velocity and its gradient, and move them; arguments and reports are those of `g2p.make_g2p`."""
    gather, advect = make_gather_3d(basis, precision), make_advect_3d(precision)
    stencil_buffers, put_stencils = make_put_stencils_3d(basis, precision)
    rows_of_points, position_at, *_ = position_access(THREE_D, precision)
    number, at_once = PRECISIONS[precision], LANES_OF[precision]

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def g2p_3d(  # type: ignore[no-untyped-def]
        storage, count, point_mass, nodes, strides, ghosts, origin, cell_size, dt, flip_fraction, threads, reports
    ):
        rows, inverse_size = rows_of_points(storage), 1.0 / cell_size
        ranges = chunk_ranges(reports.shape[0], threads)
        for thread in prange(threads_of(ranges)):
            stencils, sums_of_nodes = stencil_buffers(), np.empty((4, GROUP_3D * COMPONENTS), number)
            interpolated = Interpolated3D(sums_of_nodes[0], sums_of_nodes[1], sums_of_nodes[2], sums_of_nodes[3])
            block = next_chunk(ranges, thread)
            while block >= 0:
                sums = no_sums_3d(position_at(rows, np.uint64(0))[0])
                begin, end = points_of_block(block, reports.shape[0], count)
                for start in range(begin, end, GROUP_3D):
                    first, last = np.uint64(start), np.uint64(min(start + GROUP_3D, end))
                    for p in range(first, last, at_once):
                        put_stencils(rows, p, p - first, strides, ghosts, origin, inverse_size, stencils)
                    gather(last - first, nodes, strides, stencils, interpolated)
                    sums = advect(rows, first, last, dt, flip_fraction, cell_size, stencils, interpolated, sums)
                report_3d(reports, block, point_mass, sums)
                block = next_chunk(ranges, thread)

    return g2p_3d
