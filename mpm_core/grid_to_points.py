"""From grid to points: velocity, its gradient, the density around, and motion. Knows no law.

The moving-least-squares gradient of the grid's velocity at a point is L = sum_i w_i v_i (x_i - x_p)^T / D (Hu et al.
2018). On top of it the point keeps what the grid did not resolve of its velocity field v + A (x - x_p), for a time
constant tau:

    v <- sum_i w_i v_i^new + exp(-dt/tau) (v - sum_i w_i v_i^old)
    A <- L^new             + exp(-dt/tau) (A - L^old)

so that tau = 0 is APIC (Jiang et al. 2015), tau = infinity affine FLIP, and the loss per second does not depend on the
step. The energy of a point's field is m/2 (v^2 + A:A D); for tau = infinity the transfers keep its sum, but for terms
of the order of dt.

The grid also returns to each point pressure, density and crowding of the material around it, which tie the volumes of
points to one another, and points move a little slower or faster than the material where they crowd (`volumes`).
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable

from materials.compilation import named
from materials.tensor import SymmetricTensor, shear_strain_rate
from mpm_core.basis import Basis
from mpm_core.columns import AXX, AXY, AYX, AYY, CROWDING, LXX, LXY, LYX, LYY, MEAN_DENSITY, MEAN_PRESSURE, VX, VY, X, Y
from mpm_core.grid import BULK, COMPONENTS
from mpm_core.quads import (
    LANES,
    filled,
    first_lanes,
    greater,
    largest,
    lesser,
    put_quad,
    quad_at,
    scaled_sum,
    smallest,
    total,
)
from mpm_core.sources import CORE_MARK
from mpm_core.stencils import GROUP, four_transposed, make_find_stencils
from mpm_core.volumes import spreading_rate

BLOCK = 2048

# What `grid_to_points` reports for each block of points.
KINETIC_ENERGY, LOWEST_X, HIGHEST_X, LOWEST_Y, HIGHEST_Y, MAX_SPEED, MOVED_X, MOVED_Y = range(8)
REPORTS = 8


class Gathered(NamedTuple):
    """What the points of a group receive, four components of each point side by side.

    means               new and old velocity
    slopes_x, slopes_y  their first moments about the first node of the stencil
    bulk                mass, crowding, pressure and density of the nodes around
    crowding_x, crowding_y  first moments of the bulk about the first node of the stencil
    """

    means: Any
    slopes_x: Any
    slopes_y: Any
    bulk: Any
    crowding_x: Any
    crowding_y: Any


class Sums(NamedTuple):
    """What is reported, over the points so far, in four lanes."""

    twice_energy: Any
    moved_x: Any
    moved_y: Any
    fastest_squared: Any
    lowest_x: Any
    highest_x: Any
    lowest_y: Any
    highest_y: Any


@register_jitable(forceinline=True)
def no_sums():  # type: ignore[no-untyped-def]
    """The sums over no points."""
    zero, infinite, negative = filled(0.0), filled(np.inf), filled(-np.inf)
    return Sums(zero, zero, zero, zero, infinite, negative, infinite, negative)


@register_jitable(forceinline=True)
def added_to_sums(sums, twice_energy, moved_x, moved_y, x, y, count):  # type: ignore[no-untyped-def]
    """The sums with four points more, of which only the first `count` exist."""
    speed_squared = moved_x * moved_x + moved_y * moved_y
    return Sums(
        sums.twice_energy + first_lanes(twice_energy, count, 0.0),
        sums.moved_x + first_lanes(moved_x, count, 0.0),
        sums.moved_y + first_lanes(moved_y, count, 0.0),
        greater(sums.fastest_squared, first_lanes(speed_squared, count, 0.0)),
        lesser(sums.lowest_x, first_lanes(x, count, np.inf)),
        greater(sums.highest_x, first_lanes(x, count, -np.inf)),
        lesser(sums.lowest_y, first_lanes(y, count, np.inf)),
        greater(sums.highest_y, first_lanes(y, count, -np.inf)),
    )


@register_jitable(forceinline=True)
def report(reports, block, point_mass, sums):  # type: ignore[no-untyped-def]
    """Store the sums over a block."""
    reports[block, KINETIC_ENERGY] = 0.5 * point_mass * total(sums.twice_energy)
    reports[block, LOWEST_X], reports[block, HIGHEST_X] = smallest(sums.lowest_x), largest(sums.highest_x)
    reports[block, LOWEST_Y], reports[block, HIGHEST_Y] = smallest(sums.lowest_y), largest(sums.highest_y)
    reports[block, MAX_SPEED] = np.sqrt(largest(sums.fastest_squared))
    reports[block, MOVED_X], reports[block, MOVED_Y] = (
        point_mass * total(sums.moved_x),
        point_mass * total(sums.moved_y),
    )


@register_jitable(forceinline=True)
def updated_affine(affine, gradient, p, new, old, memory):  # type: ignore[no-untyped-def]
    """Store one component of L, and of A with what it remembers; returns the latter."""
    put_quad(gradient, p, new)
    value = new + memory * (quad_at(affine, p) - old)
    put_quad(affine, p, value)
    return value


@register_jitable(forceinline=True)
def updated_fields(rows, first, last, cell_size, memory, stencils, gathered, energies):  # type: ignore[no-untyped-def]
    """Update L, A and the averages around of a group; `energies` receives A:A D of the points."""
    lxx, lxy, lyx, lyy = rows[LXX], rows[LXY], rows[LYX], rows[LYY]
    axx, axy, ayx, ayy = rows[AXX], rows[AXY], rows[AYX], rows[AYY]
    mean_density, mean_pressure, crowding = rows[MEAN_DENSITY], rows[MEAN_PRESSURE], rows[CROWDING]
    _, _, places_x, places_y, moments_x, moments_y = stencils
    means, slopes_x, slopes_y, bulk, _, _ = gathered
    inverse_size, square = 1.0 / cell_size, cell_size * cell_size
    for p in range(first, last, LANES):
        k = p - first
        x, y = quad_at(places_x, k), quad_at(places_y, k)
        moment_x, moment_y = quad_at(moments_x, k), quad_at(moments_y, k)
        new_vx, new_vy, old_vx, old_vy = four_transposed(means, k)
        new_vx_x, new_vy_x, old_vx_x, old_vy_x = four_transposed(slopes_x, k)
        new_vx_y, new_vy_y, old_vx_y, old_vy_y = four_transposed(slopes_y, k)
        scale_x, scale_y = inverse_size / moment_x, inverse_size / moment_y
        new, old = (new_vx_x - x * new_vx) * scale_x, (old_vx_x - x * old_vx) * scale_x
        xx = updated_affine(axx, lxx, p, new, old, memory)
        new, old = (new_vy_x - x * new_vy) * scale_x, (old_vy_x - x * old_vy) * scale_x
        yx = updated_affine(ayx, lyx, p, new, old, memory)
        new, old = (new_vx_y - y * new_vx) * scale_y, (old_vx_y - y * old_vx) * scale_y
        xy = updated_affine(axy, lxy, p, new, old, memory)
        new, old = (new_vy_y - y * new_vy) * scale_y, (old_vy_y - y * old_vy) * scale_y
        yy = updated_affine(ayy, lyy, p, new, old, memory)
        _, crowded, pressure, density = four_transposed(bulk, k)
        put_quad(crowding, p, crowded)
        put_quad(mean_pressure, p, pressure)
        put_quad(mean_density, p, density)
        put_quad(energies, k, square * ((xx * xx + yx * yx) * moment_x + (xy * xy + yy * yy) * moment_y))


@register_jitable(forceinline=True)
def spread(rows, p, k, new_vx, new_vy, cell_size, dt, stencils, gathered):  # type: ignore[no-untyped-def]
    """The velocities with which points move that also go down the gradient of crowding."""
    lxx, lxy, lyx, lyy = quad_at(rows[LXX], p), quad_at(rows[LXY], p), quad_at(rows[LYX], p), quad_at(rows[LYY], p)
    shear_rate = shear_strain_rate(SymmetricTensor(lxx, lyy, 0.0, 0.5 * (lxy + lyx), 0.0, 0.0))
    speed = cell_size * spreading_rate(shear_rate, dt)
    crowded = quad_at(rows[CROWDING], p)
    _, slope_x, _, _ = four_transposed(gathered.crowding_x, k)
    _, slope_y, _, _ = four_transposed(gathered.crowding_y, k)
    slope_x = slope_x - quad_at(stencils.x, k) * crowded
    slope_y = slope_y - quad_at(stencils.y, k) * crowded
    return new_vx - speed * slope_x, new_vy - speed * slope_y


@register_jitable(forceinline=True)
def moved(rows, first, last, cell_size, dt, memory, spreads, stencils, gathered, energies, sums):  # type: ignore[no-untyped-def]
    """Update velocities and positions of a group; returns the sums with it."""
    x, y, vx, vy = rows[X], rows[Y], rows[VX], rows[VY]
    for p in range(first, last, LANES):
        new_vx, new_vy, old_vx, old_vy = four_transposed(gathered.means, p - first)
        velocity_x = new_vx + memory * (quad_at(vx, p) - old_vx)
        velocity_y = new_vy + memory * (quad_at(vy, p) - old_vy)
        if spreads:
            new_vx, new_vy = spread(rows, p, p - first, new_vx, new_vy, cell_size, dt, stencils, gathered)
        new_x, new_y = quad_at(x, p) + dt * new_vx, quad_at(y, p) + dt * new_vy
        put_quad(vx, p, velocity_x)
        put_quad(vy, p, velocity_y)
        put_quad(x, p, new_x)
        put_quad(y, p, new_y)
        twice_energy = velocity_x * velocity_x + velocity_y * velocity_y + quad_at(energies, p - first)
        sums = added_to_sums(sums, twice_energy, new_vx, new_vy, new_x, new_y, float(last - p))
    return sums


def make_gather(basis: Basis, spreads: bool) -> Callable[..., Any]:
    """A function that fills what the points of a group receive."""
    width = basis.width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{spreads:d}_{CORE_MARK}")
    def gather(count, nodes, nodes_y, stencils, gathered):  # type: ignore[no-untyped-def]
        starts, weights = stencils.starts, stencils.weights
        means, slopes_x, slopes_y, bulk, crowding_x, crowding_y = gathered
        row_length = np.uint64(nodes_y * COMPONENTS)
        for k in range(count):
            row = np.uint64(starts[k]) * np.uint64(COMPONENTS)
            mean, slope_x, slope_y = filled(0.0), filled(0.0), filled(0.0)
            around, around_x, around_y = filled(0.0), filled(0.0), filled(0.0)
            for a in range(width):
                in_row, around_in_row = filled(0.0), filled(0.0)
                for b in range(width):
                    node = row + np.uint64(b * COMPONENTS)
                    weight = weights[np.uint64((a * width + b) * GROUP) + k]
                    share = weight * quad_at(nodes, node)
                    in_row = in_row + share
                    slope_y = scaled_sum(float(b), share, slope_y)
                    around_share = weight * quad_at(nodes, node + np.uint64(BULK))
                    around_in_row = around_in_row + around_share
                    if spreads:
                        around_y = scaled_sum(float(b), around_share, around_y)
                mean = mean + in_row
                slope_x = scaled_sum(float(a), in_row, slope_x)
                around = around + around_in_row
                if spreads:
                    around_x = scaled_sum(float(a), around_in_row, around_x)
                row += row_length
            put_quad(means, LANES * k, mean)
            put_quad(slopes_x, LANES * k, slope_x)
            put_quad(slopes_y, LANES * k, slope_y)
            put_quad(bulk, LANES * k, around)
            if spreads:
                put_quad(crowding_x, LANES * k, around_x)
                put_quad(crowding_y, LANES * k, around_y)

    return gather


@cache
def make_grid_to_points(basis: Basis, spreads: bool) -> Callable[..., Any]:
    """Gather velocity, its gradient and averages of the material around from the grid, and move the points.

    `spreads` is whether points move down the gradient of crowding, `memory` exp(-dt/tau). Reports per block of points:
    kinetic energy [J/m], corners of the bounding box [m], the largest speed at which a point moves [m/s] and the
    momentum of that motion [kg/s].
    """
    gather = make_gather(basis, spreads)
    room_for_stencils, find_stencils = make_find_stencils(basis)

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{spreads:d}_{CORE_MARK}")
    def grid_to_points(  # type: ignore[no-untyped-def]
        rows, point_mass, nodes, nodes_y, ghosts, origin, cell_size, dt, memory, reports
    ):
        points = len(rows[X])
        for block in prange(reports.shape[0]):
            stencils, room = room_for_stencils(), np.empty((7, GROUP * LANES))
            energies = room[6]
            gathered = Gathered(room[0], room[1], room[2], room[3], room[4], room[5])
            sums = no_sums()
            for start in range(block * BLOCK, min(points, (block + 1) * BLOCK), GROUP):
                first, last = np.uint64(start), np.uint64(min(start + GROUP, points))
                find_stencils(rows[X], rows[Y], first, last, nodes_y, ghosts, origin, cell_size, stencils)
                gather(last - first, nodes, nodes_y, stencils, gathered)
                updated_fields(rows, first, last, cell_size, memory, stencils, gathered, energies)
                sums = moved(rows, first, last, cell_size, dt, memory, spreads, stencils, gathered, energies, sums)
            report(reports, block, point_mass, sums)

    return grid_to_points
