"""Symmetric tensors and their invariants, one definition each.

Tensors are tension-positive; pressure is compression-positive. Every function here takes and returns scalars or
`SymmetricTensor`s, works as plain Python and is compiled together with the law that calls it. So do the operators of a
tensor, a + b, a - b, -a, 2.0 * a, a * 2.0 and a / 2.0 (compiled: `tensor_operators`).
"""

import math
from numbers import Real
from typing import Any, NamedTuple

from grainlaw.materials.pointwise import pointwise

# Times a third is a fraction of the time of a division by three.
THIRD = 1.0 / 3.0


class SymmetricTensor(NamedTuple):
    """The six independent components of a symmetric 3 x 3 tensor (stress [Pa] or strain rate [1/s])."""

    xx: float
    yy: float
    zz: float
    xy: float
    yz: float
    xz: float

    def __add__(self, other: "SymmetricTensor") -> "SymmetricTensor":  # type: ignore[override]
        """The sum of two tensors; a tuple would be appended, so nothing else is taken."""
        return added(self, _checked(other, "+"))

    def __radd__(self, other: Any) -> "SymmetricTensor":
        """Only reached with something that is no tensor."""
        return added(_checked(other, "+"), self)

    def __sub__(self, other: "SymmetricTensor") -> "SymmetricTensor":
        return difference(self, _checked(other, "-"))

    def __rsub__(self, other: Any) -> "SymmetricTensor":
        return difference(_checked(other, "-"), self)

    def __neg__(self) -> "SymmetricTensor":
        return negative(self)

    def __mul__(self, factor: float) -> "SymmetricTensor":  # type: ignore[override]
        return scaled(self, _checked_number(factor, "*"))

    def __rmul__(self, factor: float) -> "SymmetricTensor":  # type: ignore[override]
        return scaled(self, _checked_number(factor, "*"))

    def __truediv__(self, divisor: float) -> "SymmetricTensor":
        return divided(self, _checked_number(divisor, "/"))


# Above that of NumPy's numbers, with which a product is a tensor, and below that of its arrays.
SymmetricTensor.__array_priority__ = -1.0  # type: ignore[attr-defined]


def _checked(operand: Any, sign: str) -> SymmetricTensor:
    if isinstance(operand, SymmetricTensor):
        return operand
    raise TypeError(f"SymmetricTensor {sign} {type(operand).__name__}: only another SymmetricTensor can stand there")


def _checked_number(operand: Any, sign: str) -> Any:
    if isinstance(operand, float | int | Real):
        return operand
    raise TypeError(f"SymmetricTensor {sign} {type(operand).__name__}: only a number can stand there")


@pointwise
def isotropic(value: float) -> SymmetricTensor:
    """Value * 1."""
    return SymmetricTensor(value, value, value, 0.0, 0.0, 0.0)


@pointwise
def scaled(a: SymmetricTensor, factor: float) -> SymmetricTensor:
    """Factor * a."""
    return SymmetricTensor(factor * a.xx, factor * a.yy, factor * a.zz, factor * a.xy, factor * a.yz, factor * a.xz)


@pointwise
def added(a: SymmetricTensor, b: SymmetricTensor) -> SymmetricTensor:
    """A + b."""
    return SymmetricTensor(a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.xz + b.xz)


@pointwise
def difference(a: SymmetricTensor, b: SymmetricTensor) -> SymmetricTensor:
    """A - b."""
    return SymmetricTensor(a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.yz - b.yz, a.xz - b.xz)


@pointwise
def negative(a: SymmetricTensor) -> SymmetricTensor:
    """-a."""
    return SymmetricTensor(-a.xx, -a.yy, -a.zz, -a.xy, -a.yz, -a.xz)


@pointwise
def divided(a: SymmetricTensor, divisor: float) -> SymmetricTensor:
    """A over a number."""
    return SymmetricTensor(
        a.xx / divisor, a.yy / divisor, a.zz / divisor, a.xy / divisor, a.yz / divisor, a.xz / divisor
    )


@pointwise
def trace(a: SymmetricTensor) -> float:
    """tr(a)."""
    return a.xx + a.yy + a.zz


@pointwise
def contraction(a: SymmetricTensor, b: SymmetricTensor) -> float:
    """A : b."""
    return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + 2.0 * (a.xy * b.xy + a.yz * b.yz + a.xz * b.xz)


@pointwise
def congruent(a: SymmetricTensor, b: SymmetricTensor) -> SymmetricTensor:
    """A b a, which is symmetric; with b = 1 the square of a."""
    xx = a.xx * b.xx + a.xy * b.xy + a.xz * b.xz
    xy = a.xx * b.xy + a.xy * b.yy + a.xz * b.yz
    xz = a.xx * b.xz + a.xy * b.yz + a.xz * b.zz
    yx = a.xy * b.xx + a.yy * b.xy + a.yz * b.xz
    yy = a.xy * b.xy + a.yy * b.yy + a.yz * b.yz
    yz = a.xy * b.xz + a.yy * b.yz + a.yz * b.zz
    zx = a.xz * b.xx + a.yz * b.xy + a.zz * b.xz
    zy = a.xz * b.xy + a.yz * b.yy + a.zz * b.yz
    zz = a.xz * b.xz + a.yz * b.yz + a.zz * b.zz
    return SymmetricTensor(
        xx * a.xx + xy * a.xy + xz * a.xz,
        yx * a.xy + yy * a.yy + yz * a.yz,
        zx * a.xz + zy * a.yz + zz * a.zz,
        xx * a.xy + xy * a.yy + xz * a.yz,
        yx * a.xz + yy * a.yz + yz * a.zz,
        xx * a.xz + xy * a.yz + xz * a.zz,
    )


@pointwise
def determinant(a: SymmetricTensor) -> float:
    """det(a)."""
    return a.xx * (a.yy * a.zz - a.yz * a.yz) - a.xy * (a.xy * a.zz - a.yz * a.xz) + a.xz * (a.xy * a.yz - a.yy * a.xz)


@pointwise
def deviator(a: SymmetricTensor) -> SymmetricTensor:
    """A - tr(a)/3 1."""
    mean = trace(a) * THIRD
    return SymmetricTensor(a.xx - mean, a.yy - mean, a.zz - mean, a.xy, a.yz, a.xz)


@pointwise
def pressure(stress: SymmetricTensor) -> float:
    """P = -tr(sigma)/3 [Pa], compression-positive."""
    return trace(stress) * -THIRD


@pointwise
def half_norm(deviatoric: SymmetricTensor) -> float:
    """sqrt(1/2 a:a) of a tensor that is already deviatoric."""
    return math.sqrt(0.5 * contraction(deviatoric, deviatoric))


@pointwise
def equivalent_shear_stress(stress: SymmetricTensor) -> float:
    """Tau = sqrt(1/2 s:s) = q/sqrt(3) [Pa]."""
    return half_norm(deviator(stress))


@pointwise
def deviatoric_stress(stress: SymmetricTensor) -> float:
    """Q = sqrt(3/2 s:s) [Pa]."""
    return math.sqrt(3.0) * half_norm(deviator(stress))


@pointwise
def shear_strain_rate(strain_rate: SymmetricTensor) -> float:
    """gamma_dot = sqrt(1/2 D_d:D_d) [1/s]; half of the engineering rate in simple shear."""
    return half_norm(deviator(strain_rate))


@pointwise
def volumetric_strain_rate(strain_rate: SymmetricTensor) -> float:
    """d(eps_v)/dt = -tr(D) [1/s], compression-positive."""
    return -trace(strain_rate)


@pointwise
def assembled_stress(mean_pressure: float, deviatoric: SymmetricTensor) -> SymmetricTensor:
    """Sigma = -p 1 + s [Pa]."""
    return isotropic(-mean_pressure) + deviatoric
