"""exp and ln for arguments that are mostly small, as the strain increments of a step are.

Near zero their power series are exact to the last bits and take a fraction of the library's time.
"""

import math

from grainlaw.materials.pointwise import pointwise

SMALL = 0.01


def fused(a: float, b: float, c: float) -> float:
    """Return a b + c, which compiled code rounds once (`compilation`): one operation rather than two."""
    return a * b + c


@pointwise
def exponential(x: float) -> float:
    """exp(x), to two units in the last place."""
    if abs(x) > SMALL:
        return math.exp(x)
    square = x * x
    return 1.0 + (
        x + square * (0.5 + x * (1.0 / 6.0) + square * (1.0 / 24.0 + x * (1.0 / 120.0) + square * (1.0 / 720.0)))
    )


@pointwise
def exponential_near(x: float, known: float, of_known: float) -> float:
    """exp(x), where exp of a known number, mostly close to x, is there already."""
    difference = x - known
    if abs(difference) > SMALL:
        return math.exp(x)
    return of_known * exponential(difference)


@pointwise
def log_ratio(a: float, b: float) -> float:
    """ln(a/b) of two positive numbers, to two units in the last place where they are close."""
    u = (a - b) / (a + b)
    if abs(u) > SMALL:
        return math.log(a / b)
    square = u * u
    return 2.0 * u * (1.0 + square * (1.0 / 3.0 + square * (1.0 / 5.0 + square * (1.0 / 7.0))))


@pointwise
def growth_over(x: float, rate: float) -> float:
    """(exp(rate x) - 1)/rate, for a positive rate."""
    growth = rate * x
    if abs(growth) > SMALL:
        return math.expm1(growth) / rate
    series = 0.5 + growth * (1.0 / 6.0 + growth * (1.0 / 24.0 + growth * (1.0 / 120.0 + growth * (1.0 / 720.0))))
    return x * (1.0 + growth * series)


@pointwise
def mean_over_path(growth: float, shrunk: float) -> float:
    """Mean over final value of what grows by exp(growth), (1 - exp(-growth))/growth; shrunk is exp(-growth)."""
    if abs(growth) > SMALL:
        return (1.0 - shrunk) / growth
    return 1.0 - growth * (0.5 - growth * (1.0 / 6.0 - growth * (1.0 / 24.0 - growth * (1.0 / 120.0))))


@pointwise
def log_derivative_of_mean(growth: float, shrunk: float) -> float:
    """Derivative of ln(mean_over_path) with respect to growth."""
    if abs(growth) > SMALL:
        return (shrunk * growth - (1.0 - shrunk)) / ((1.0 - shrunk) * growth)
    return growth * (1.0 / 12.0) - 0.5
