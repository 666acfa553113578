"""Turning with the material: the stress by the spin of a step, the strain rate of its middle to its end.

The velocity gradient of a step belongs to its middle, the stress to its ends. With the stress turned by the whole spin
and the strain rate by half of it both stand at the end of the step, which is of second order (as the midpoint rule of
Hughes & Winget 1980, Int. J. Numer. Methods Eng. 15, 1862).
"""

from grainlaw.materials.elementary import fused
from grainlaw.materials.single_precision import adaptable
from grainlaw.materials.tensor import SymmetricTensor


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
def at_end_of_step(xx, yy, xy, angle):  # type: ignore[no-untyped-def]
    """In-plane components of a strain rate after a rotation by half of `angle`, to its second order."""
    mean, half, cosine = 0.5 * (xx + yy), 0.5 * (xx - yy), 1.0 - 0.5 * angle * angle
    turned = half * cosine - xy * angle
    return mean + turned, mean - turned, half * angle + xy * cosine


@adaptable
def rotation_matrix(x, y, z):  # type: ignore[no-untyped-def]
    """The rotation by a vector, 1 + a K + b K^2 with K of the vector (Rodrigues), row after row.

    The power series of a = sin(t)/t and b = (1 - cos(t))/t^2 end below 1e-12 at an angle of a quarter.
    """
    u = x * x + y * y + z * z
    # the coefficients are inverse factorials
    a = fused(u, fused(u, fused(u, fused(u, 1.0 / 362880.0, -1.0 / 5040.0), 1.0 / 120.0), -1.0 / 6.0), 1.0)
    b = fused(u, fused(u, fused(u, -1.0 / 40320.0, 1.0 / 720.0), -1.0 / 24.0), 0.5)
    cosine, ax, ay, az, bx, by = 1.0 - b * u, a * x, a * y, a * z, b * x, b * y
    xy, xz, yz = bx * y, bx * z, by * z
    return (
        *(fused(bx, x, cosine), xy - az, xz + ay),
        *(xy + az, fused(by, y, cosine), yz - ax),
        *(xz - ay, yz + ax, fused(b * z, z, cosine)),
    )


@adaptable
def rotated_tensor(s, r):  # type: ignore[no-untyped-def]
    """R s R^T of a symmetric tensor, with R row after row."""
    xx, xy, xz, yx, yy, yz, zx, zy, zz = r
    # R s
    a, b, c = xx * s.xx + xy * s.xy + xz * s.xz, xx * s.xy + xy * s.yy + xz * s.yz, xx * s.xz + xy * s.yz + xz * s.zz
    d, e, f = yx * s.xx + yy * s.xy + yz * s.xz, yx * s.xy + yy * s.yy + yz * s.yz, yx * s.xz + yy * s.yz + yz * s.zz
    g, h, i = zx * s.xx + zy * s.xy + zz * s.xz, zx * s.xy + zy * s.yy + zz * s.yz, zx * s.xz + zy * s.yz + zz * s.zz
    return SymmetricTensor(
        a * xx + b * xy + c * xz,
        d * yx + e * yy + f * yz,
        g * zx + h * zy + i * zz,
        a * yx + b * yy + c * yz,
        d * zx + e * zy + f * zz,
        a * zx + b * zy + c * zz,
    )


@adaptable
def turning_rate(s, x, y, z):  # type: ignore[no-untyped-def]
    """K s - s K of a symmetric tensor, with K of the vector (x, y, z)."""
    in_z, in_x, in_y = x * s.yz - y * s.xz, y * s.xz - z * s.xy, z * s.xy - x * s.yz
    return SymmetricTensor(
        in_x + in_x,
        in_y + in_y,
        in_z + in_z,
        z * (s.xx - s.yy) + y * s.yz - x * s.xz,
        x * (s.yy - s.zz) + z * s.xz - y * s.xy,
        y * (s.zz - s.xx) + x * s.xy - z * s.yz,
    )


@adaptable
def at_end_of_step_3d(rate, x, y, z):  # type: ignore[no-untyped-def]
    """A strain rate after the rotation by a vector, to its second order."""
    first = turning_rate(rate, x, y, z)
    return rate + first + 0.5 * turning_rate(first, x, y, z)
