"""Turning with the material: the stress by the spin of a step, the strain rate of its middle to its end.

The velocity gradient of a step belongs to its middle, the stress to its ends. With the stress turned by the whole spin
and the strain rate by half of it both stand at the end of the step, which is of second order (as the midpoint rule of
Hughes & Winget 1980, Int. J. Numer. Methods Eng. 15, 1862).
"""

from grainlaw.materials.elementary import fused
from grainlaw.materials.single_precision import adaptable


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
