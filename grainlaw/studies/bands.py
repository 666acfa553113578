"""Bands of what a scene answers: what a calibration left open, and what the numbers of the computation owe.

Draws of the parameters give 5 and 95 % quantiles, the k-th of n draws standing for k/(n + 1), so that a band holds what
it says for any n. The numerical variance is

    s^2 = (q_h - q_(h/2))^2 + (q_dt - q_(dt/2))^2 + s_place^2,

with q at the estimate: on the cells of the scene and on half of them, with its step and half of it, and the variance of
q over places of the points within their cells. An error that falls with the cell is at least the first difference, and
twice it where it falls in proportion; it counts as one standard deviation. Both parts are taken as independent:
the band reaches sqrt(a^2 + (1.645 s)^2) from the median where that of the draws reaches a.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]

LOWEST, HIGHEST = 0.05, 0.95
# Of the normal distribution, in standard deviations.
REACH = 1.6449
# The 5 % quantile of fewer draws lies below all of them.
FEWEST_DRAWS = 19


@dataclass(frozen=True)
class NumericalSpread:
    """Variances of a quantity by what it owes to cells, steps and places of points; nothing for what was not run."""

    cell: Array
    step: Array
    place: Array

    @property
    def variance(self) -> Array:
        """Their sum."""
        return self.cell + self.step + self.place


def numerical_spread(
    estimate: Array, finer: Array | None, shorter: Array | None, places: Sequence[Array]
) -> NumericalSpread:
    """The spread from a quantity at the estimate, on half the cells, with half the step, and at two places or more."""
    nothing = np.zeros_like(estimate)
    return NumericalSpread(
        cell=nothing if finer is None else (estimate - finer) ** 2,
        step=nothing if shorter is None else (estimate - shorter) ** 2,
        place=np.var(places, axis=0, ddof=1) if len(places) > 1 else nothing,
    )


@dataclass(frozen=True)
class Band:
    """A quantity, each of one shape.

    median          of the draws
    drawn_lower, drawn_upper   5 and 95 % of the draws
    lower, upper    with the numerical spread
    parameters      variance of the draws
    numerics        variances of the computation
    """

    median: Array
    drawn_lower: Array
    drawn_upper: Array
    lower: Array
    upper: Array
    parameters: Array
    numerics: NumericalSpread

    @property
    def share_of_parameters(self) -> Array:
        """Of the variance; NaN where nothing varies."""
        total = self.parameters + self.numerics.variance
        return np.divide(self.parameters, total, out=np.full_like(total, np.nan), where=total > 0.0)

    def holds(self, values: Array) -> NDArray[np.bool_]:
        """Where values lie within the band."""
        return np.asarray((self.lower <= values) & (values <= self.upper))


def band(draws: Array, numerics: NumericalSpread, least: float = -np.inf) -> Band:
    """The band of draws, shape (draws, ...), of a quantity that is at least so large."""
    low, median, high = np.quantile(draws, (LOWEST, 0.5, HIGHEST), axis=0, method="weibull")
    reach = REACH**2 * numerics.variance
    return Band(
        median=median,
        drawn_lower=low,
        drawn_upper=high,
        lower=np.maximum(median - np.sqrt((median - low) ** 2 + reach), least),
        upper=median + np.sqrt((high - median) ** 2 + reach),
        parameters=np.var(draws, axis=0, ddof=1),
        numerics=numerics,
    )
