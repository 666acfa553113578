"""The stress pass: the only kernel that knows a law. One is generated for each law that a scene uses.

For each point: rotate the stress with the material (exact rotation by the increment of spin),
bring the density to the end of the step (midpoint rule for d ln rho = -tr D dt), call the law.

Loose grains take on a strain besides that of the motion, which ties the volumes of points to one another (`volumes`).
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
from grainlaw.materials.tensor import THIRD, SymmetricTensor, shear_strain_rate, trace
from grainlaw.mpm_core.kernels.law_at_points import (
    make_apply_law,
    make_find_stiffness,
    make_largest_signal_speed,
    ordered_bits,
)
from grainlaw.mpm_core.kernels.rows import rows_of
from grainlaw.mpm_core.kernels.simd.arithmetic import filled, first_lanes, total
from grainlaw.mpm_core.kernels.simd.registers import LANES, quad_at
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.volume_coupling import SQUEEZE, closing_strain, evening_share, evening_strain
from grainlaw.mpm_core.layout import (
    CROWDING,
    DENSITY,
    FIRST_STATE,
    LXX,
    LXY,
    LYX,
    LYY,
    MEAN_AROUND,
    REST_DENSITY,
    SXX,
    SXY,
    SYY,
    SZZ,
)
from grainlaw.mpm_core.parallel.blocks import points_of_block
from grainlaw.mpm_core.parallel.work_sharing import next_part, shares_of, threads_of

# Points that go through the parts of the pass together; they stay in the nearest cache.
GROUP = 512

# What `stress_pass` reports for each block of points.
MAX_SIGNAL_SPEED, INTERNAL_WORK, MAX_INCREMENT = range(3)
REPORTS = 3


@adaptable
def rotated(sxx, syy, sxy, angle):  # type: ignore[no-untyped-def]
    """In-plane stress components after a rotation by `angle`.

    Sine and cosine of twice the angle are the power series that end below 1e-12 at an angle of a quarter.
    """
    t = angle + angle
    u = t * t
    # the coefficients are inverse factorials
    sine = fused(u, fused(u, fused(u, fused(u, 1.0 / 362880.0, -1.0 / 5040.0), 1.0 / 120.0), -1.0 / 6.0), 1.0) * t
    fourth = fused(u, fused(u, fused(u, -1.0 / 3628800.0, 1.0 / 40320.0), -1.0 / 720.0), 1.0 / 24.0)
    cosine = fused(u, fused(u, fourth, -0.5), 1.0)
    mean, half = 0.5 * (sxx + syy), 0.5 * (sxx - syy)
    turned = fused(half, cosine, -sxy * sine)
    return mean + turned, mean - turned, fused(half, sine, sxy * cosine)


@adaptable
def tie_volumes(rows, first, last, duration, exchange, stiffness, ties):  # type: ignore[no-untyped-def]
    """The compressive strain that ties the volumes of points to one another for a time [s], into `ties`."""
    lxx, lxy, lyx, lyy = rows[LXX], rows[LXY], rows[LYX], rows[LYY]
    sxx, syy, szz = rows[SXX], rows[SYY], rows[SZZ]
    density, mean_around, crowding = rows[DENSITY], rows[MEAN_AROUND], rows[CROWDING]
    for p in range(first, last):
        motion = SymmetricTensor(lxx[p], lyy[p], 0.0, 0.5 * (lxy[p] + lyx[p]), 0.0, 0.0)
        shear_rate = shear_strain_rate(motion)
        share = evening_share(shear_rate, exchange)
        pressure = (sxx[p] + syy[p] + szz[p]) * -THIRD
        evening = evening_strain(pressure, mean_around[p], stiffness[p - first], share)
        closing = closing_strain(density[p], mean_around[p], share)
        has_contact = sxx[p] != 0.0 or syy[p] != 0.0
        ties[p - first] = (evening if has_contact else closing) + SQUEEZE * duration * shear_rate * crowding[p]


@adaptable
def bring_forward(rows, first, last, dt, ties, room, rest):  # type: ignore[no-untyped-def]
    """Rotate the stress and bring the density to the end of the step; returns the largest volumetric increment.

    `ties` are compressive strains besides those of the motion. The room receives the power of the old stress over mass,
    and the new volume over mass. In single precision `rest` is what singles leave out of the densities: slow strains
    change a density by less than its rounding in a step, and would be lost.
    """
    works, volumes = room
    lxx, lxy, lyx, lyy = rows[LXX], rows[LXY], rows[LYX], rows[LYY]
    sxx, syy, sxy = rows[SXX], rows[SYY], rows[SXY]
    density = rows[DENSITY]
    largest = np.int64(0)
    for p in range(first, last):
        motion = SymmetricTensor(lxx[p], lyy[p], 0.0, 0.5 * (lxy[p] + lyx[p]), 0.0, 0.0)
        half_increment = 0.5 * (dt * trace(motion) - ties[p - first])
        xx, yy, xy = rotated(sxx[p], syy[p], sxy[p], 0.5 * dt * (lyx[p] - lxy[p]))
        # rho (1 - h)/(1 + h), and both volumes, from a single division
        grown, shrunk = 1.0 + half_increment, 1.0 - half_increment
        inverse = 1.0 / (density[p] * grown * shrunk)
        power = fused(xx, motion.xx, fused(yy, motion.yy, 2.0 * xy * motion.xy))
        works[p - first] = power * (inverse * grown * shrunk)
        volumes[p - first] = inverse * grown * grown
        sxx[p], syy[p], sxy[p] = xx, yy, xy
        # by which the density changes from rho to rho (1 - h)/(1 + h)
        scale, strain = density[p] * (density[p] * shrunk * inverse), -2.0 * half_increment
        if rest is None:
            density[p] = fused(strain, scale, density[p])
        else:
            change = fused(strain, scale, rest[p])
            new = density[p] + change
            rest[p] = change - (new - density[p])
            density[p] = new
        largest = max(largest, ordered_bits(abs(2.0 * half_increment)))
    return largest


@register_jitable
def no_rest(storage):  # type: ignore[no-untyped-def]
    """Doubles leave nothing out."""


@register_jitable
def rest_in_single(storage):  # type: ignore[no-untyped-def]
    """What singles leave out of the densities."""
    return storage[REST_DENSITY]


def make_accumulate_shear_strain(row: int | None, mark: str) -> Callable[..., Any]:
    """The loop over points that brings their shear strain forward, in this row; without one, nothing."""
    if row is None:
        return no_shear_strain

    @adaptable
    @named(mark)
    def accumulate_shear_strain(rows, first, last, dt):  # type: ignore[no-untyped-def]
        lxx, lxy, lyx, lyy, shear_strain = rows[LXX], rows[LXY], rows[LYX], rows[LYY], rows[row]
        for p in range(first, last):
            motion = SymmetricTensor(lxx[p], lyy[p], 0.0, 0.5 * (lxy[p] + lyx[p]), 0.0, 0.0)
            shear_strain[p] += dt * shear_strain_rate(motion)

    return accumulate_shear_strain


@adaptable
def no_shear_strain(rows, first, last, dt):  # type: ignore[no-untyped-def]
    """Do nothing."""


@register_jitable
def work_done(rows, first, last, room):  # type: ignore[no-untyped-def]
    """The mean of the powers of the old and the new stress over mass, summed over the points [W/kg].

    In four sums side by side: an addition waits for the one before it.
    """
    lxx, lxy, lyx, lyy = rows[LXX], rows[LXY], rows[LYX], rows[LYY]
    sxx, syy, sxy = rows[SXX], rows[SYY], rows[SXY]
    works, volumes = room
    sums = filled(0.0)
    for p in range(first, last, LANES):
        k = p - first
        across = quad_at(sxy, p) * (quad_at(lxy, p) + quad_at(lyx, p))
        power = quad_at(sxx, p) * quad_at(lxx, p) + quad_at(syy, p) * quad_at(lyy, p) + across
        work = 0.5 * (quad_at(works, k) + power * quad_at(volumes, k))
        sums = sums + (work if p + np.uint64(LANES) <= last else first_lanes(work, float(last - p), 0.0))
    return total(sums)


@cache
def make_stress_pass(law: PointwiseLaw, keeps_shear_strain: bool, precision: str) -> Callable[..., Any]:
    """The stress pass of a law; it takes the law's parameters as a plain tuple. The precision is that of the points.

    It ties the volumes of the points for a time `tied` [s], zero for not in this step; `exchange` is that time over the
    time constant of the transfer. Reports per block of points: the largest signal speed c + |v| [m/s], the work of the
    stress on the strain [J/m], and the largest volumetric strain increment of the step. Where anything is not finite,
    the last one is NaN.
    """
    mark, number = f"{law.mark}_{CORE_MARK}_{keeps_shear_strain:d}_{precision}", PRECISIONS[precision]
    apply_law, find_stiffness = make_apply_law(law, mark), make_find_stiffness(law, mark)
    largest_signal_speed = make_largest_signal_speed(law, mark)
    after_state = FIRST_STATE + len(law.state._fields)
    all_rows = (0.0,) * (after_state + keeps_shear_strain)
    shear_strain = make_accumulate_shear_strain(after_state if keeps_shear_strain else None, mark)
    accumulate = in_precision(shear_strain, precision)
    rest_of_density = rest_in_single if precision == "single" else no_rest
    forward, tie = in_precision(bring_forward, precision), in_precision(tie_volumes, precision)

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(mark)
    def stress_pass(  # type: ignore[no-untyped-def]
        storage, count, point_mass, parameters, dt, tied, exchange, threads, reports
    ):
        rows, shares = rows_of(storage, all_rows), shares_of(reports.shape[0], threads)
        for thread in prange(threads_of(shares)):
            arrays, step = np.zeros((3, GROUP), number), number(dt)
            ties, stiffness, room = arrays[0], arrays[1], (arrays[1], arrays[2])
            block = next_part(shares, thread)
            while block >= 0:
                fastest, largest, work = np.int64(0), np.int64(0), 0.0
                begin, end = points_of_block(block, reports.shape[0], count)
                for start in range(begin, end, GROUP):
                    first, last = np.uint64(start), np.uint64(min(start + GROUP, end))
                    if tied > 0.0:
                        find_stiffness(rows, first, last, parameters, stiffness)
                        tie(rows, first, last, number(tied), number(exchange), stiffness, ties)
                    accumulate(rows, first, last, step)
                    increment = forward(rows, first, last, step, ties, room, rest_of_density(storage))
                    apply_law(rows, first, last, ties, parameters, dt)
                    speed = largest_signal_speed(rows, first, last, parameters)
                    work += work_done(rows, first, last, room)
                    fastest, largest = max(fastest, speed), max(largest, increment)
                reports[block, MAX_SIGNAL_SPEED] = np.int64(fastest).view(np.float64)
                reports[block, INTERNAL_WORK] = point_mass * dt * work
                reports[block, MAX_INCREMENT] = np.int64(largest).view(np.float64)
                block = next_part(shares, thread)

    return stress_pass
