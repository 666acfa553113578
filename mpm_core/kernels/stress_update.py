"""The stress pass: the only kernel that knows a law. One is generated for each law that a scene uses.

For each point: turn stress and strain rate to the end of the step (`rotation`), bring the density there (midpoint rule
for d ln rho = -tr D dt), call the law.

Loose grains take on a strain besides that of the motion, which couples the volumes of points (`volume_coupling`).
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable

from grainlaw.materials.compilation import PointwiseLaw, named
from grainlaw.materials.elementary import fused
from grainlaw.materials.precision import PRECISIONS
from grainlaw.materials.single_precision import adaptable, in_precision
from grainlaw.materials.tensor import pressure, shear_strain_rate
from grainlaw.mpm_core.kernels.kinematics import kinematics
from grainlaw.mpm_core.kernels.law_at_points import (
    make_apply_law,
    make_find_stiffness,
    make_largest_diffusivity,
    make_largest_signal_speed,
    ordered_bits,
)
from grainlaw.mpm_core.kernels.rows import rows_of
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.volume_coupling import (
    closing_strain,
    smoothing_share,
    smoothing_strain,
)
from grainlaw.mpm_core.layout import DENSITY_REMAINDER, layout_of
from grainlaw.mpm_core.parallel.blocks import points_of_block
from grainlaw.mpm_core.parallel.work_sharing import chunk_ranges, next_chunk, threads_of
from grainlaw.mpm_core.space import Space

# Points that go through the parts of the pass together; they stay in the nearest cache.
GROUP = 512

# What `stress_pass` reports for each block of points.
MAX_SIGNAL_SPEED, INTERNAL_WORK, MAX_INCREMENT, MAX_DIFFUSIVITY = range(4)
REPORTS = 4


def make_couple_volumes(space: Space, precision: str) -> Callable[..., Any]:
    """A function that finds the compressive strain that couples the volumes of points for a time [s]."""
    layout, of_point = layout_of(space), kinematics(space, precision)
    stress_at, motion = of_point.stress, of_point.motion
    density_row, pressure_around, density_around = (
        layout.density,
        layout.neighbour_pressure,
        layout.neighbour_density,
    )

    @adaptable
    @named(f"{space.name}_{precision}_{CORE_MARK}")
    def couple_volumes(rows, first, last, duration, stiffness, coupling):  # type: ignore[no-untyped-def]
        density, neighbour_pressure, neighbour_density = rows[density_row], rows[pressure_around], rows[density_around]
        for p in range(first, last):
            share = smoothing_share(shear_strain_rate(motion(rows, p)), duration)
            carried = pressure(stress_at(rows, p))
            smoothing = smoothing_strain(carried, neighbour_pressure[p], stiffness[p - first], share)
            closing = closing_strain(density[p], neighbour_density[p], share)
            coupling[p - first] = smoothing if carried > 0.0 else closing

    return in_precision(couple_volumes, precision)


def make_bring_forward(space: Space, precision: str) -> Callable[..., Any]:
    """A function that turns the stress and brings the density to the end of the step.

    It returns the largest volumetric increment of the motion. `coupling` are compressive strains besides those of the
    motion. The step after this one has none, so that they bound no step; they are only to be finite. The buffers
    receive the power of the old stress over mass, and the new volume over mass. In single precision `remainder` is what
    singles leave out of the densities: slow strains change a density by less than its rounding in a step, and would be
    lost.
    """
    of_point, density_row = kinematics(space, precision), layout_of(space).density
    volumetric_rate, turned_power = of_point.volumetric_rate, of_point.turned_power

    @adaptable
    @named(f"{space.name}_{precision}_{CORE_MARK}")
    def bring_forward(rows, first, last, dt, coupling, buffers, remainder):  # type: ignore[no-untyped-def]
        works, volumes = buffers
        density, largest = rows[density_row], np.int64(0)
        for p in range(first, last):
            works[p - first] = turned_power(rows, p, dt)
        for p in range(first, last):
            increment = dt * volumetric_rate(rows, p)
            half_increment = 0.5 * (increment - coupling[p - first])
            # rho (1 - h)/(1 + h), and both volumes, from a single division
            grown, shrunk = 1.0 + half_increment, 1.0 - half_increment
            inverse = 1.0 / (density[p] * grown * shrunk)
            works[p - first] *= inverse * grown * shrunk
            volumes[p - first] = inverse * grown * grown
            # by which the density changes from rho to rho (1 - h)/(1 + h)
            scale, strain = density[p] * (density[p] * shrunk * inverse), -2.0 * half_increment
            if remainder is None:
                density[p] = fused(strain, scale, density[p])
            else:
                change = fused(strain, scale, remainder[p])
                new = density[p] + change
                remainder[p] = change - (new - density[p])
                density[p] = new
            largest = max(largest, ordered_bits(abs(increment) + 0.0 * coupling[p - first]))
        return largest

    return in_precision(bring_forward, precision)


@register_jitable
def no_remainder(storage):  # type: ignore[no-untyped-def]
    """Doubles leave nothing out."""


@register_jitable
def remainder_in_single(storage):  # type: ignore[no-untyped-def]
    """What singles leave out of the densities."""
    return storage[DENSITY_REMAINDER]


def make_accumulate_shear_strain(space: Space, row: int, precision: str, mark: str) -> Callable[..., Any]:
    """The loop over points that brings their shear strain forward, which stands in this row."""
    motion = kinematics(space, precision).motion

    @adaptable
    @named(mark)
    def accumulate_shear_strain(rows, first, last, dt):  # type: ignore[no-untyped-def]
        shear_strain = rows[row]
        for p in range(first, last):
            shear_strain[p] += dt * shear_strain_rate(motion(rows, p))

    return in_precision(accumulate_shear_strain, precision)


def make_work_done(space: Space, precision: str) -> Callable[..., Any]:
    """A function that sums up the mean of the powers of old and new stress over mass [W/kg].

    In axisymmetry times the mass of each point, which is one elsewhere [W/rad].
    """
    power, mass_row, hoop, number = (
        kinematics(space, precision).power,
        layout_of(space).mass,
        space.hoop,
        PRECISIONS[precision],
    )
    half = number(0.5)

    @register_jitable
    @named(f"{space.name}_{precision}_{CORE_MARK}")
    def work_done(rows, first, last, dt, buffers):  # type: ignore[no-untyped-def]
        works, volumes = buffers
        for p in range(first, last):
            k = p - first
            works[k] = half * (works[k] + power(rows, p, dt) * volumes[k])
            if hoop:
                works[k] *= rows[mass_row][p]
        # In four sums side by side: an addition waits for the one before it. None is left over behind the last point.
        count = last - first
        works[count : count + np.uint64(3)] = 0.0
        a, b, c, d = 0.0, 0.0, 0.0, 0.0
        for k in range(np.uint64(0), count, np.uint64(4)):
            a, b, c, d = (
                a + works[k],
                b + works[k + np.uint64(1)],
                c + works[k + np.uint64(2)],
                d + works[k + np.uint64(3)],
            )
        return a + b + c + d

    return work_done


@cache
def make_stress_pass(space: Space, law: PointwiseLaw, precision: str) -> Callable[..., Any]:
    """The stress pass of a law; it takes the law's parameters as a plain tuple. The precision is that of the points.

    It couples the volumes of the points for a time `coupled_time` [s], zero for not in this step. The row behind the
    law's state is the shear strain where `keeps_shear_strain`; else it may not exist. Reports per block of points: the
    largest signal speed c + |v| [m/s], the work of the stress on the strain [J/m], the largest volumetric strain
    increment of the motion, NaN where anything is not finite, and the largest viscosity over density [m2/s].
    """
    mark, number = f"{space.name}_{law.mark}_{CORE_MARK}_{precision}", PRECISIONS[precision]
    apply_law, find_stiffness = make_apply_law(space, law, mark), make_find_stiffness(space, law, mark)
    largest_signal_speed = make_largest_signal_speed(space, law, mark)
    largest_diffusivity = make_largest_diffusivity(space, law, mark)
    after_state = layout_of(space).first_state + len(law.state._fields)
    all_rows = (0.0,) * (after_state + 1)
    accumulate = make_accumulate_shear_strain(space, after_state, precision, mark)
    density_remainder = remainder_in_single if precision == "single" else no_remainder
    forward, couple = make_bring_forward(space, precision), make_couple_volumes(space, precision)
    work_done = make_work_done(space, precision)

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(mark)
    def stress_pass(  # type: ignore[no-untyped-def]
        storage, count, point_mass, parameters, dt, coupled_time, keeps_shear_strain, threads, reports
    ):
        rows, ranges = rows_of(storage, all_rows), chunk_ranges(reports.shape[0], threads)
        for thread in prange(threads_of(ranges)):
            arrays, step = np.zeros((3, GROUP), number), number(dt)
            coupling, stiffness, buffers = arrays[0], arrays[1], (arrays[1], arrays[2])
            block = next_chunk(ranges, thread)
            while block >= 0:
                fastest, largest, diffusivity, work = np.int64(0), np.int64(0), np.int64(0), 0.0
                begin, end = points_of_block(block, reports.shape[0], count)
                for start in range(begin, end, GROUP):
                    first, last = np.uint64(start), np.uint64(min(start + GROUP, end))
                    if coupled_time > 0.0:
                        find_stiffness(rows, first, last, parameters, stiffness)
                        couple(rows, first, last, number(coupled_time), stiffness, coupling)
                    if keeps_shear_strain:
                        accumulate(rows, first, last, step)
                    increment = forward(rows, first, last, step, coupling, buffers, density_remainder(storage))
                    apply_law(rows, first, last, coupling, parameters, dt)
                    speed = largest_signal_speed(rows, first, last, parameters)
                    diffusivity = max(diffusivity, largest_diffusivity(rows, first, last, parameters, dt))
                    work += work_done(rows, first, last, step, buffers)
                    fastest, largest = max(fastest, speed), max(largest, increment)
                reports[block, MAX_SIGNAL_SPEED] = np.int64(fastest).view(np.float64)
                reports[block, INTERNAL_WORK] = point_mass * dt * work
                reports[block, MAX_INCREMENT] = np.int64(largest).view(np.float64)
                reports[block, MAX_DIFFUSIVITY] = np.int64(diffusivity).view(np.float64)
                block = next_chunk(ranges, thread)

    return stress_pass
