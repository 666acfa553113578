"""What moves and carries a point in each space: stress, strain rate, spin, and the power of one on the other.

In plane strain the material does not stretch along z; in axisymmetry it does, around the axis, by L_zz = v_r/r; in
three dimensions all components of stress and velocity gradient are there.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from grainlaw.materials.compilation import named
from grainlaw.materials.elementary import fused
from grainlaw.materials.precision import PRECISIONS
from grainlaw.materials.single_precision import adaptable, in_precision
from grainlaw.materials.tensor import SymmetricTensor, contraction
from grainlaw.mpm_core.kernels.rotation import (
    at_end_of_step,
    at_end_of_step_3d,
    rotated,
    rotated_tensor,
    rotation_matrix,
)
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.space import Space


class Kinematics(NamedTuple):
    """What compiled code reads and stores of point p in `rows`, as numbers of one precision.

    stress           (rows, p) -> the stress [Pa]
    put_stress       (rows, p, stress)
    volumetric_rate  (rows, p) -> tr D [1/s]
    motion           (rows, p) -> the strain rate D in the middle of the step [1/s]
    strain_rate      (rows, p, dt) -> D, turned to the end of the step [1/s]
    turned_power     (rows, p, dt) -> the power of the stress, which is turned to the end of the step [W/m3]
    power            (rows, p, dt) -> the power of the stress as it is at the end of the step [W/m3]
    """

    stress: Callable[..., Any]
    put_stress: Callable[..., Any]
    volumetric_rate: Callable[..., Any]
    motion: Callable[..., Any]
    strain_rate: Callable[..., Any]
    turned_power: Callable[..., Any]
    power: Callable[..., Any]


@cache
def kinematics(space: Space, precision: str) -> Kinematics:
    """The kinematics of a space, with numbers of a precision."""
    make = _in_three_dimensions if space.axes == 3 else _in_a_plane
    return Kinematics(*(in_precision(function, precision) for function in make(space, precision)))


def _in_a_plane(space: Space, precision: str) -> Kinematics:
    """Plane strain, and axisymmetry with its stretch around the axis."""
    layout, number = layout_of(space), PRECISIONS[precision]
    sxx, syy, szz, sxy = range(layout.stress, layout.stress + 4)
    lxx, lxy, lyx, lyy = range(layout.gradient, layout.gradient + 4)
    lzz, hoop, nothing, mark = layout.hoop_gradient, space.hoop, number(0.0), f"{space.name}_{precision}_{CORE_MARK}"

    @adaptable
    @named(mark)
    def stress_at(rows, p):  # type: ignore[no-untyped-def]
        xx, yy, zz, xy = number(rows[sxx][p]), number(rows[syy][p]), number(rows[szz][p]), number(rows[sxy][p])
        return SymmetricTensor(xx, yy, zz, xy, nothing, nothing)

    @adaptable
    @named(mark)
    def put_stress(rows, p, stress):  # type: ignore[no-untyped-def]
        rows[sxx][p], rows[syy][p], rows[szz][p], rows[sxy][p] = stress.xx, stress.yy, stress.zz, stress.xy

    @adaptable
    @named(mark)
    def volumetric_rate(rows, p):  # type: ignore[no-untyped-def]
        in_plane = number(rows[lxx][p]) + number(rows[lyy][p])
        return in_plane + number(rows[lzz][p]) if hoop else in_plane

    @adaptable
    @named(mark)
    def motion(rows, p):  # type: ignore[no-untyped-def]
        zz, xy = number(rows[lzz][p]) if hoop else nothing, 0.5 * (number(rows[lxy][p]) + number(rows[lyx][p]))
        return SymmetricTensor(number(rows[lxx][p]), number(rows[lyy][p]), zz, xy, nothing, nothing)

    @adaptable
    @named(mark)
    def spin_angle(rows, p, dt):  # type: ignore[no-untyped-def]
        return 0.5 * dt * (number(rows[lyx][p]) - number(rows[lxy][p]))

    @adaptable
    @named(mark)
    def strain_rate(rows, p, dt):  # type: ignore[no-untyped-def]
        rate = motion(rows, p)
        xx, yy, xy = at_end_of_step(rate.xx, rate.yy, rate.xy, spin_angle(rows, p, dt))
        return SymmetricTensor(xx, yy, rate.zz, xy, nothing, nothing)

    @adaptable
    @named(mark)
    def turned_power(rows, p, dt):  # type: ignore[no-untyped-def]
        rate, angle = motion(rows, p), spin_angle(rows, p, dt)
        xx, yy, xy = rotated(rows[sxx][p], rows[syy][p], rows[sxy][p], angle)
        rate_xx, rate_yy, rate_xy = at_end_of_step(rate.xx, rate.yy, rate.xy, angle)
        around = rows[szz][p] * rate.zz if hoop else nothing
        rows[sxx][p], rows[syy][p], rows[sxy][p] = xx, yy, xy
        in_plane = fused(xx, rate_xx, fused(yy, rate_yy, 2.0 * xy * rate_xy))
        return in_plane + around if hoop else in_plane

    @adaptable
    @named(mark)
    def power(rows, p, dt):  # type: ignore[no-untyped-def]
        rate = strain_rate(rows, p, dt)
        in_plane = rows[sxx][p] * rate.xx + rows[syy][p] * rate.yy + rows[sxy][p] * (rate.xy + rate.xy)
        return in_plane + rows[szz][p] * rate.zz if hoop else in_plane

    return Kinematics(stress_at, put_stress, volumetric_rate, motion, strain_rate, turned_power, power)


def _in_three_dimensions(space: Space, precision: str) -> Kinematics:
    layout, number = layout_of(space), PRECISIONS[precision]
    sxx, syy, szz, sxy, syz, sxz = range(layout.stress, layout.stress + 6)
    lxx, lxy, lxz, lyx, lyy, lyz, lzx, lzy, lzz = range(layout.gradient, layout.gradient + 9)
    mark = f"{space.name}_{precision}_{CORE_MARK}"

    @adaptable
    @named(mark)
    def stress_at(rows, p):  # type: ignore[no-untyped-def]
        xx, yy, zz = number(rows[sxx][p]), number(rows[syy][p]), number(rows[szz][p])
        xy, yz, xz = number(rows[sxy][p]), number(rows[syz][p]), number(rows[sxz][p])
        return SymmetricTensor(xx, yy, zz, xy, yz, xz)

    @adaptable
    @named(mark)
    def put_stress(rows, p, stress):  # type: ignore[no-untyped-def]
        rows[sxx][p], rows[syy][p], rows[szz][p] = stress.xx, stress.yy, stress.zz
        rows[sxy][p], rows[syz][p], rows[sxz][p] = stress.xy, stress.yz, stress.xz

    @adaptable
    @named(mark)
    def volumetric_rate(rows, p):  # type: ignore[no-untyped-def]
        return number(rows[lxx][p]) + number(rows[lyy][p]) + number(rows[lzz][p])

    @adaptable
    @named(mark)
    def motion(rows, p):  # type: ignore[no-untyped-def]
        return SymmetricTensor(
            number(rows[lxx][p]),
            number(rows[lyy][p]),
            number(rows[lzz][p]),
            0.5 * (number(rows[lxy][p]) + number(rows[lyx][p])),
            0.5 * (number(rows[lyz][p]) + number(rows[lzy][p])),
            0.5 * (number(rows[lxz][p]) + number(rows[lzx][p])),
        )

    @adaptable
    @named(mark)
    def half_angle(rows, p, dt):  # type: ignore[no-untyped-def]
        quarter = 0.25 * dt
        return (
            quarter * (number(rows[lzy][p]) - number(rows[lyz][p])),
            quarter * (number(rows[lxz][p]) - number(rows[lzx][p])),
            quarter * (number(rows[lyx][p]) - number(rows[lxy][p])),
        )

    @adaptable
    @named(mark)
    def strain_rate(rows, p, dt):  # type: ignore[no-untyped-def]
        x, y, z = half_angle(rows, p, dt)
        return at_end_of_step_3d(motion(rows, p), x, y, z)

    @adaptable
    @named(mark)
    def turned_power(rows, p, dt):  # type: ignore[no-untyped-def]
        x, y, z = half_angle(rows, p, dt)
        stress = rotated_tensor(stress_at(rows, p), rotation_matrix(x + x, y + y, z + z))
        put_stress(rows, p, stress)
        return contraction(stress, at_end_of_step_3d(motion(rows, p), x, y, z))

    @adaptable
    @named(mark)
    def power(rows, p, dt):  # type: ignore[no-untyped-def]
        return contraction(stress_at(rows, p), strain_rate(rows, p, dt))

    return Kinematics(stress_at, put_stress, volumetric_rate, motion, strain_rate, turned_power, power)
