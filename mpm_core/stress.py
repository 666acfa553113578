"""The stress pass: the only kernel that knows a law. One is generated for each law that a scene uses.

For each point: rotate the stress with the material (exact rotation by the increment of spin; Hughes & Winget 1980),
bring the density to the end of the step (midpoint rule for d ln rho = -tr D dt), call the law.

Points without contact. In a flow each point sums up its own error of volume, which no force of the grid can see: after
a collapse more than half of the points of a stiff law would have opened for good, while the others carry twice the
pressure. While the material deforms, a point without stress therefore closes towards the density of the material around
it, by the strain ln(rho_around/rho) over the time constant of the transfer. At rest it must not pump: the rate is
multiplied by gamma_dot/(gamma_dot + QUIET_RATE). Points with stress, elastic and cohesive material are not touched.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import njit, prange
from numba.cpython.unsafe.tuple import tuple_setitem
from numba.extending import register_jitable

from materials.compilation import PointwiseLaw, named
from materials.tensor import SymmetricTensor, added, contraction, isotropic, shear_strain_rate, trace
from mpm_core.columns import (
    DENSITY,
    DENSITY_AROUND,
    FIRST_STATE,
    LXX,
    LXY,
    LYX,
    LYY,
    SHEAR_STRAIN,
    SXX,
    SXY,
    SYY,
    SZZ,
    VX,
    VY,
)
from mpm_core.sources import CORE_MARK
from mpm_core.transfer import BLOCK

# The shear rate [1/s] below which material counts as at rest.
QUIET_RATE = 0.1

# What `stress_pass` reports for each block of points.
MAX_SIGNAL_SPEED, INTERNAL_WORK, MAX_INCREMENT = range(3)
REPORTS = 3


@register_jitable
def replaced(values, k, value):  # type: ignore[no-untyped-def]
    """A copy of a tuple with one item replaced.

    A function of this module rather than a call in `load`: the disk cache is keyed on what a kernel closes over, and
    the compiler's intrinsic itself is another object in every process.
    """
    return tuple_setitem(values, k, value)  # type: ignore[call-arg]


def make_state_access(state_class: type[Any], mark: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Functions that load a law's state of one point from its columns, and store it."""
    count = len(state_class._fields)
    zeros = (0.0,) * count

    if count == 0:

        @register_jitable
        @named(mark)
        def load_nothing(columns, p):  # type: ignore[no-untyped-def]
            return state_class()

        @register_jitable
        @named(mark)
        def store_nothing(columns, p, state):  # type: ignore[no-untyped-def]
            pass

        return load_nothing, store_nothing

    @register_jitable
    @named(mark)
    def load(columns, p):  # type: ignore[no-untyped-def]
        values = zeros
        for k in range(count):
            values = replaced(values, k, columns[k, p])
        return state_class(*values)

    @register_jitable
    @named(mark)
    def store(columns, p, state):  # type: ignore[no-untyped-def]
        for k in range(count):
            columns[k, p] = state[k]

    return load, store


@register_jitable
def rotated(sxx, syy, sxy, angle):  # type: ignore[no-untyped-def]
    """In-plane stress components after a rotation by `angle`, in Cayley's form, which is exactly orthogonal.

    The angle of that form is 2 atan(t); t = tan(angle/2) to third order.
    """
    t = 0.5 * angle * (1.0 + angle * angle / 12.0)
    inverse = 1.0 / (1.0 + t * t)
    cosine, sine = (1.0 - t * t) * inverse, 2.0 * t * inverse
    cosine_2, sine_2 = cosine * cosine - sine * sine, 2.0 * sine * cosine
    mean, half = 0.5 * (sxx + syy), 0.5 * (sxx - syy)
    turned = half * cosine_2 - sxy * sine_2
    return mean + turned, mean - turned, half * sine_2 + sxy * cosine_2


@register_jitable
def closing_strain(density, around, shear_rate, exchange):  # type: ignore[no-untyped-def]
    """The compressive strain of one step towards the density around; `exchange` is dt over the time constant."""
    share = exchange * shear_rate / (shear_rate + QUIET_RATE)
    # ln(around/density) to third order, bounded by 2 for points that have lost contact
    difference = max(0.0, 2.0 * (around - density) / (around + density))
    return difference * share / (1.0 + share)


@register_jitable
def ordered_bits(value):  # type: ignore[no-untyped-def]
    """The bits of a non-negative float as an integer: the same order, and NaN above everything.

    A maximum of integers is vectorised and keeps NaN; a maximum of floats does one or the other.
    """
    return np.float64(value).view(np.int64)


@cache
def make_stress_pass(law: PointwiseLaw, keeps_shear_strain: bool) -> Callable[..., Any]:
    """The stress pass of a law; it takes the law's parameters as a plain tuple, and dt over the time constant.

    Reports per block of points: the largest signal speed c + |v| [m/s], the work of the stress on the strain [J/m], and
    the largest volumetric strain increment of the step. Where anything is not finite, the last one is NaN.
    """
    update, sound_speed = law.update, law.sound_speed
    parameter_class = law.parameters
    mark = f"{law.mark}_{CORE_MARK}_{keeps_shear_strain:d}"
    load, store = make_state_access(law.state, mark)

    @register_jitable
    @named(mark)
    def update_block(  # type: ignore[no-untyped-def]
        vx, vy, lxx, lxy, lyx, lyy, sxx, syy, szz, sxy, density, around, shear_strain, states, parameters, dt, exchange
    ):
        law_parameters = parameter_class(*parameters)
        work = 0.0
        fastest, largest = np.int64(0), np.int64(0)
        for p in range(len(vx)):
            motion = SymmetricTensor(lxx[p], lyy[p], 0.0, 0.5 * (lxy[p] + lyx[p]), 0.0, 0.0)
            shear_rate = shear_strain_rate(motion)
            xx, yy, xy = rotated(sxx[p], syy[p], sxy[p], 0.5 * dt * (lyx[p] - lxy[p]))
            has_contact = sxx[p] != 0.0 or syy[p] != 0.0
            closing = 0.0 if has_contact else closing_strain(density[p], around[p], shear_rate, exchange)
            strain_rate = added(motion, isotropic(-closing / (3.0 * dt)))
            half_increment = 0.5 * (dt * trace(motion) - closing)
            new_density = density[p] * (1.0 - half_increment) / (1.0 + half_increment)
            old_stress = SymmetricTensor(xx, yy, szz[p], xy, 0.0, 0.0)
            stress, state = update(old_stress, strain_rate, new_density, load(states, p), law_parameters, dt)
            store(states, p, state)
            work += contraction(added(old_stress, stress), motion) / (density[p] + new_density)
            sxx[p], syy[p], szz[p], sxy[p] = stress.xx, stress.yy, stress.zz, stress.xy
            density[p] = new_density
            if keeps_shear_strain:
                shear_strain[p] += dt * shear_rate
            signal_speed = sound_speed(stress, new_density, state, law_parameters) + np.sqrt(
                vx[p] * vx[p] + vy[p] * vy[p]
            )
            fastest = max(fastest, ordered_bits(signal_speed))
            not_finite = 0.0 * (stress.xx + stress.yy + stress.zz + stress.xy + signal_speed)
            largest = max(largest, ordered_bits(abs(2.0 * half_increment + not_finite)))
        return fastest, work, largest

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(mark)
    def stress_pass(points, point_mass, parameters, dt, exchange, reports):  # type: ignore[no-untyped-def]
        for block in prange(reports.shape[0]):
            rows = points[:, block * BLOCK : (block + 1) * BLOCK]
            fastest, work, largest = update_block(
                rows[VX],
                rows[VY],
                rows[LXX],
                rows[LXY],
                rows[LYX],
                rows[LYY],
                rows[SXX],
                rows[SYY],
                rows[SZZ],
                rows[SXY],
                rows[DENSITY],
                rows[DENSITY_AROUND],
                rows[SHEAR_STRAIN],
                rows[FIRST_STATE:],
                parameters,
                dt,
                exchange,
            )
            reports[block, MAX_SIGNAL_SPEED] = np.int64(fastest).view(np.float64)
            reports[block, INTERNAL_WORK] = point_mass * dt * work
            reports[block, MAX_INCREMENT] = np.int64(largest).view(np.float64)

    return stress_pass
