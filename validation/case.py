"""What a validation case is: something measured, what it must be and by whose word, and a variant that must fail.

A band that anything fits into proves nothing. Each case therefore also measures a negative control, the same problem
with one deliberate mistake, and passes only if its own measurements lie within their bands and the control's do not.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np


class Effort(StrEnum):
    """How much a case may cost: QUICK in seconds, for every change; FULL for observed orders and fine grids."""

    QUICK = "quick"
    FULL = "full"


@dataclass(frozen=True)
class Measurement:
    """One number against its reference: the error, in the norm of the case, and the band that it must not exceed.

    `reference` is None for a quantity that only has to stay below its band.
    """

    name: str
    unit: str
    measured: float
    reference: float | None
    error: float
    band: float

    @property
    def within_band(self) -> bool:
        """Whether the error is a number and no larger than the band."""
        return bool(self.error <= self.band)


def relative_error(name: str, unit: str, measured: float, reference: float, band: float) -> Measurement:
    """The error as a share of the reference."""
    return scaled_error(name, unit, measured, reference, abs(reference), band)


def scaled_error(name: str, unit: str, measured: float, reference: float, scale: float, band: float) -> Measurement:
    """The error as a share of a scale of the problem."""
    return Measurement(name, unit, float(measured), float(reference), float(abs(measured - reference) / scale), band)


def upper_bound(name: str, unit: str, measured: float, band: float) -> Measurement:
    """A quantity that is its own error."""
    return Measurement(name, unit, float(measured), None, abs(float(measured)), band)


@dataclass(frozen=True)
class Convergence:
    """Errors over step or cell sizes; `least_order` is what the fitted order must reach (None: stated only)."""

    name: str
    against: str
    sizes: tuple[float, ...]
    errors: tuple[float, ...]
    least_order: float | None = None

    @property
    def orders(self) -> tuple[float, ...]:
        """Order between each two neighbouring sizes."""
        pairs = zip(self.sizes, self.sizes[1:], self.errors, self.errors[1:], strict=False)
        return tuple(
            math.log(coarse / fine) / math.log(size / smaller) if coarse > 0.0 and fine > 0.0 else math.nan
            for size, smaller, coarse, fine in pairs
        )

    @property
    def fitted_order(self) -> float:
        """Slope of the straight line through all errors in logarithmic axes."""
        return float(np.polyfit(np.log(self.sizes), np.log(self.errors), 1)[0])

    @property
    def reaches_order(self) -> bool:
        """Whether the fitted order is the one asked for."""
        return self.least_order is None or bool(self.fitted_order >= self.least_order)


@dataclass(frozen=True)
class Curve:
    """Points of a plot; a reference is drawn as a line, a measurement as markers, a control as a broken line."""

    label: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    role: str = "measured"


def curve(label: str, x: object, y: object, role: str = "measured") -> Curve:
    """A curve from two sequences; `role` is measured, reference or control."""
    return Curve(label, tuple(np.asarray(x, float).tolist()), tuple(np.asarray(y, float).tolist()), role)


@dataclass(frozen=True)
class Figure:
    """One plot of the report; `logarithmic` names the axes that are: "", "y" or "xy"."""

    title: str
    x_label: str
    y_label: str
    curves: tuple[Curve, ...]
    logarithmic: str = ""


@dataclass(frozen=True)
class Evidence:
    """What a case measured."""

    measurements: tuple[Measurement, ...]
    convergence: tuple[Convergence, ...] = ()
    figures: tuple[Figure, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Case:
    """A validation case.

    name        by which the command line calls it
    title       one line for tables
    proves      what would be wrong if it failed
    reference   the exact formula or published value, and its source
    norm        how the error is counted
    mistake     the deliberate mistake of the negative control
    measure     runs the case
    control     runs the negative control; at least one of its measurements has to leave its band
    """

    name: str
    title: str
    proves: str
    reference: str
    norm: str
    mistake: str
    measure: Callable[[Effort], Evidence]
    control: Callable[[Effort], tuple[Measurement, ...]]
