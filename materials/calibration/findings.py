"""What a fit says about the parameters: estimates, 95 % intervals, correlations, and in words what is not determined.

At the solution the residuals r are taken as linear in the coordinates u, with Jacobian J. The covariance of u is then
(J^T J)^-1, times s^2 = |r|^2/(measurements - parameters) where the data come without standard errors. Intervals are
those of the normal or, with s^2, of Student's distribution. A parameter is determined if its interval reaches no
further than a factor 2 from the estimate (half of it, or a tenth of the width of its bounds, where u is linear). With J
in units of this reach, singular values below the quantile belong to combinations that the data do not determine.

Source: Seber & Wild (1989), Nonlinear Regression, chapters 2 and 5.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm, t

from grainlaw.materials.calibration.coordinates import Coordinate
from grainlaw.materials.calibration.fit import Fit

Array = NDArray[np.float64]

CONFIDENCE = 0.95
LOGARITHMIC_REACH = math.log(2.0)
SHARE, SHARE_OF_BOUNDS = 0.5, 0.1
ENDLESS = 10.0
# Share of a parameter in a singular vector from which it is named, and the correlation from which two are.
NAMED_SHARE = 0.2
NAMED_CORRELATION = 0.95
IMPROBABLE = 0.01
SMALLEST_SINGULAR_VALUE = 1e-12


@dataclass(frozen=True)
class Estimate:
    """A fitted parameter: SI unit, value, 95 % interval, and whether the data determine it."""

    name: str
    unit: str
    value: float
    lower: float
    upper: float
    determined: bool


@dataclass(frozen=True)
class Findings:
    """What a fit says."""

    fit: Fit

    @cached_property
    def freedom(self) -> int:
        """Measurements less parameters."""
        return self.fit.residuals.size - self.fit.solution.size

    @cached_property
    def misfit(self) -> float:
        """Sum of the squared weighted residuals; chi^2 where the standard errors are known."""
        return float(np.sum(self.fit.residuals**2))

    @cached_property
    def reach(self) -> Array:
        """How far from the solution an interval may reach for its parameter to be determined, shape (parameters,)."""
        return np.array(
            [reach_of(at, u) for at, u in zip(self.fit.coordinates, self.fit.solution.tolist(), strict=True)]
        )

    @cached_property
    def _combined(self) -> tuple[Array, Array]:
        """Standard deviations along the singular vectors of the scaled Jacobian, ascending, and these vectors."""
        return self._combinations_of(self.fit.jacobian * self.reach)

    def _combinations_of(self, scaled: Array) -> tuple[Array, Array]:
        _, values, vectors = np.linalg.svd(scaled, full_matrices=False)
        noise = 1.0 if self.fit.knows_errors else math.sqrt(self.misfit / self.freedom)
        return noise / np.maximum(values, SMALLEST_SINGULAR_VALUE * max(float(values[0]), 1e-300)), vectors

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the coordinates, shape (parameters, parameters)."""
        deviations, vectors = self._combined
        return np.asarray((vectors.T * deviations**2) @ vectors) * np.outer(self.reach, self.reach)

    @cached_property
    def determined(self) -> NDArray[np.bool_]:
        """Which of the parameters the data determine, shape (parameters,)."""
        return np.array([found.determined for found in self.estimates])

    @cached_property
    def covariance_of_determined(self) -> Array:
        """Covariance of the coordinates that the data determine, with the others held at their estimates."""
        reach = self.reach[self.determined]
        deviations, vectors = self._combinations_of(self.fit.jacobian[:, self.determined] * reach)
        return np.asarray((vectors.T * deviations**2) @ vectors) * np.outer(reach, reach)

    @cached_property
    def correlation(self) -> Array:
        """Correlation matrix of the coordinates, shape (parameters, parameters)."""
        deviations = np.sqrt(np.maximum(np.diag(self.covariance), 1e-300))
        return np.asarray(self.covariance / np.outer(deviations, deviations))

    @cached_property
    def quantile(self) -> float:
        """Half of the 95 % interval over the standard deviation."""
        tail = 0.5 * (1.0 + CONFIDENCE)
        return float(norm.ppf(tail) if self.fit.knows_errors else t.ppf(tail, self.freedom))

    @cached_property
    def estimates(self) -> tuple[Estimate, ...]:
        """The fitted parameters."""
        half_widths = self.quantile * np.sqrt(np.diag(self.covariance))
        found = []
        for index, at in enumerate(self.fit.coordinates):
            u, half_width = float(self.fit.solution[index]), float(half_widths[index])
            determined = half_width <= self.reach[index]
            lower, upper = at.interval(u, half_width)
            found.append(Estimate(at.name, at.declaration.unit, at.value(u), lower, upper, bool(determined)))
        return tuple(found)

    @cached_property
    def remarks(self) -> tuple[str, ...]:
        """What a reader has to know before using the estimates, in words; undetermined parameters first."""
        return tuple(itertools.chain(self._undetermined(), self._combinations(), self._correlated(), self._quality()))

    def _undetermined(self) -> Iterator[str]:
        for at, found in zip(self.fit.coordinates, self.estimates, strict=True):
            if not found.determined:
                endless = found.upper - found.value > ENDLESS * abs(found.value)
                most = f"spans most of {at.declaration.bounds}"
                interval = most if endless else f"is {found.lower:.3g} to {found.upper:.3g}"
                yield f"the data do not determine {found.name}: its 95 % interval {interval}; fix it or add data"
        for name in self.fit.without_effect:
            yield f"the data do not depend on {name}, which is left at {self.fit.values[name]:g}"
        for name in self.fit.left_out:
            yield f"{name} depends on no fitted parameter and takes no part in the fit"

    def _combinations(self) -> Iterator[str]:
        """Directions in which several parameters can move together without a worse fit."""
        for deviation, vector in zip(*self._combined, strict=True):
            named = [index for index in np.argsort(-np.abs(vector)) if abs(vector[index]) >= NAMED_SHARE]
            if self.quantile * deviation > 1.0 and len(named) > 1:
                names = [self.fit.coordinates[index].name for index in named]
                signs = [vector[index] * vector[named[0]] > 0.0 for index in named]
                moves = [f"{name} {'rises' if rises else 'falls'}" for name, rises in zip(names, signs, strict=True)]
                yield (
                    f"only a combination of {' and '.join(names)} is determined: the fit hardly changes as "
                    f"{' and '.join(moves)}"
                )

    def _correlated(self) -> Iterator[str]:
        for first, second in itertools.combinations(range(len(self.estimates)), 2):
            value = float(self.correlation[first, second])
            names = [self.estimates[index] for index in (first, second)]
            if abs(value) > NAMED_CORRELATION and all(found.determined for found in names):
                yield f"{names[0].name} and {names[1].name} are correlated ({value:.3f}): use them together only"

    def _quality(self) -> Iterator[str]:
        if not self.fit.converged and all(found.determined for found in self.estimates):
            yield "the search was stopped before it came to an end; begin it nearer to the solution"
        for found, u in zip(self.fit.coordinates, self.fit.solution.tolist(), strict=True):
            lowest, highest = found.bounds
            if min(u - lowest, highest - u) < 1e-3:
                yield f"{found.name} lies at a bound of {found.declaration.bounds}: its interval is not to be relied on"
        if self.fit.knows_errors:
            probability = float(chi2.sf(self.misfit, self.freedom))
            if probability < IMPROBABLE:
                yield (
                    f"the law misses the data by more than their standard errors (chi2 = {self.misfit:.3g} with "
                    f"{self.freedom} degrees of freedom, probability {probability:.1g}): the intervals are too narrow"
                )
        else:
            yield "the data come without standard errors: their scatter about the law stands in for them"


def reach_of(at: Coordinate, u: float) -> float:
    """How far from u the interval of a coordinate may reach for its parameter to count as determined."""
    if at.logarithmic:
        return LOGARITHMIC_REACH
    lowest, highest = at.bounds
    of_bounds = SHARE_OF_BOUNDS * (highest - lowest) if math.isfinite(highest - lowest) else 0.0
    return max(SHARE * abs(u), of_bounds) or SHARE
