"""The coordinates in which parameters are fitted: no dimension, logarithmic where every positive value is allowed."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import Parameter

Array = NDArray[np.float64]

# exp of more leaves the range of numbers.
LARGEST_EXPONENT = 690.0


@dataclass(frozen=True)
class Coordinate:
    """u = ln x where the bounds of the parameter x are (0, inf), else u = x/scale."""

    name: str
    declaration: Parameter
    scale: float

    @property
    def logarithmic(self) -> bool:
        """Whether u = ln x."""
        interval = self.declaration.interval
        return interval.lower == 0.0 and interval.lower_open and math.isinf(interval.upper)

    @property
    def bounds(self) -> tuple[float, float]:
        """The interval of u."""
        if self.logarithmic:
            return -math.inf, math.inf
        return self.declaration.interval.lower / self.scale, self.declaration.interval.upper / self.scale

    def of_value(self, value: float) -> float:
        """The coordinate of a value of the parameter."""
        return math.log(value) if self.logarithmic else value / self.scale

    def value(self, coordinate: float) -> float:
        """The value of the parameter at a coordinate."""
        if self.logarithmic:
            return math.exp(min(max(coordinate, -LARGEST_EXPONENT), LARGEST_EXPONENT))
        return coordinate * self.scale

    def interval(self, coordinate: float, half_width: float) -> tuple[float, float]:
        """Values at coordinate -+ half_width, within the bounds."""
        lowest, highest = self.bounds
        below, above = max(lowest, coordinate - half_width), min(highest, coordinate + half_width)
        lower = 0.0 if self.logarithmic and below < -LARGEST_EXPONENT else self.value(below)
        return lower, math.inf if self.logarithmic and above > LARGEST_EXPONENT else self.value(above)


def coordinate(name: str, declaration: Parameter, start: float) -> Coordinate:
    """The coordinate of a parameter, scaled by its start value or, where that is small, by the width of its bounds."""
    width = declaration.interval.upper - declaration.interval.lower
    return Coordinate(name, declaration, max(abs(start), 0.1 * width if math.isfinite(width) else 0.0) or 1.0)


def coordinates_of(chosen: Sequence[Coordinate], values: Mapping[str, float]) -> Array:
    """The coordinates of values by name, shape (parameters,)."""
    return np.array([found.of_value(values[found.name]) for found in chosen])


def values_at(chosen: Sequence[Coordinate], point: Array, others: Mapping[str, float]) -> dict[str, float]:
    """Values by name at coordinates, shape (parameters,), beside those of the other parameters."""
    return {**others, **{found.name: found.value(u) for found, u in zip(chosen, point.tolist(), strict=True)}}


def bounds_of(chosen: Sequence[Coordinate]) -> Array:
    """Lower and upper bounds of the coordinates, shape (2, parameters)."""
    return np.array([found.bounds for found in chosen]).T


def off_bounds(point: Array, bounds: Array, margin: float) -> Array:
    """A point at least `margin` inside its bounds, or a quarter of their width: a search begins between them."""
    margins = np.minimum(margin, 0.25 * (bounds[1] - bounds[0]))
    return np.asarray(np.clip(point, bounds[0] + margins, bounds[1] - margins))
