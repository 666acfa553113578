"""Fitting: least squares within the declared bounds, and the Jacobian from which everything else follows."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from grainlaw.materials import InputError, Law, SimulationError, get_material
from grainlaw.materials.calibration.coordinates import (
    Coordinate,
    bounds_of,
    coordinate,
    coordinates_of,
    off_bounds,
    values_at,
)
from grainlaw.materials.calibration.data import DataSet, read_data
from grainlaw.materials.calibration.model import ForwardModel, Values
from grainlaw.materials.element.specimen import base_values
from grainlaw.materials.errors import nearest_name

Array = NDArray[np.float64]

# Far above the noise of the held stresses (1e-10), far below the curvature of any law.
DIFFERENCE = 1e-4
# Of the sum of squares: an estimate is then within a thousandth of its standard deviation.
TOLERANCE = 1e-7
# Change of all residuals as a parameter changes by its own size: in standard errors (True) or, without them, relative.
SMALLEST_EFFECT = {True: 1e-3, False: 1e-5}


@dataclass(frozen=True)
class Fit:
    """What least squares found.

    sources      what it was fitted to, in words
    knows_errors whether the residuals are in standard errors
    coordinates  of the fitted parameters
    solution     their values in these coordinates, shape (parameters,)
    start        where the search began, by name, with every parameter of the law
    values       the same at the end
    residuals    at the end, shape (measurements,)
    jacobian     of the residuals in the coordinates, shape (measurements, parameters)
    without_effect  parameters that were left at their start because no measurement depends on them
    left_out     measured columns that depend on no fitted parameter, as "NAME of FILE"; they take no part
    converged    whether the search came to an end of its own
    """

    law: Law
    sources: tuple[str, ...]
    knows_errors: bool
    coordinates: tuple[Coordinate, ...]
    solution: Array
    start: Values
    values: Values
    residuals: Array
    jacobian: Array
    without_effect: tuple[str, ...]
    left_out: tuple[str, ...]
    converged: bool


@dataclass(frozen=True)
class ElementFit(Fit):
    """A fit to element tests, and the model that answers them."""

    model: ForwardModel


def calibrate(
    law_name: str,
    paths: Sequence[Path],
    fitted: Sequence[str] = (),
    fixed: Mapping[str, float] | None = None,
    parameters: str | Path | None = None,
) -> ElementFit:
    """Fit parameters of a law to data files.

    fitted      names of the parameters to fit; none: all that are not fixed and on which the data depend
    fixed       values by name that stay as they are
    parameters  where the search begins: a parameter set, a TOML file, or None for the law's first set

    Raises InputError for an unknown name, a value out of bounds, a faulty file or too few data, and SimulationError if
    the law cannot follow a test at the start values.
    """
    law = get_material(law_name)
    data = tuple(found for path in paths for found in read_data(path, law))
    return fit_to_data(law, data, fitted, {**base_values(law, parameters)[0], **(fixed or {})}, tuple(fixed or ()))


def fit_to_data(
    law: Law, data: Sequence[DataSet], fitted: Sequence[str], start: Values, fixed: Sequence[str] = ()
) -> ElementFit:
    """As `calibrate`, for data that are read already and start values by name."""
    model = ForwardModel(law, tuple(data))
    checked = law.checked(start, law.name)._asdict()
    check_names(law, fitted, fixed)
    for name in fitted:
        if name in _stated(data, law):
            raise InputError(f"'{name}' cannot be fitted: the data state its value")
    candidates = fitted or [name for name in law.parameter_declarations if name not in {*fixed, *_stated(data, law)}]
    chosen = tuple(coordinate(name, law.parameter_declarations[name], checked[name]) for name in candidates)
    effects = np.abs(_jacobian(model, chosen, coordinates_of(chosen, checked), checked, model.residuals(checked)))
    noticeable = SMALLEST_EFFECT[model.knows_errors]
    without_effect: tuple[str, ...] = ()
    if not fitted:
        kept = np.linalg.norm(effects, axis=0) > noticeable
        without_effect = tuple(found.name for found, has_effect in zip(chosen, kept, strict=True) if not has_effect)
        chosen = tuple(found for found, has_effect in zip(chosen, kept, strict=True) if has_effect)
    model, left_out = _measurements_that_depend(model, effects.max(axis=1) > noticeable / math.sqrt(len(effects)))
    if not (chosen and model.data):
        raise InputError(f"nothing to fit: the data depend on no free parameter of {law.name}")
    size = model.residuals(checked).size
    if size <= len(chosen):
        names = ", ".join(found.name for found in chosen)
        raise InputError(f"{size} measurements cannot determine {len(chosen)} parameters: {names}")
    return _solved(model, chosen, checked, without_effect, left_out)


def _measurements_that_depend(model: ForwardModel, depends: NDArray[np.bool_]) -> tuple[ForwardModel, tuple[str, ...]]:
    """The model without the measured columns of which no row depends on a parameter, and the names of these columns."""
    kept_data, left_out, start = [], [], 0
    for data in model.data:
        kept = []
        for measured in data.measured:
            rows = int(np.sum(np.isfinite(measured.values)))
            if np.any(depends[start : start + rows]):
                kept.append(measured)
            else:
                left_out.append(f"{measured.name} of {data.label}")
            start += rows
        if kept:
            kept_data.append(replace(data, measured=tuple(kept)))
    return ForwardModel(model.law, tuple(kept_data)), tuple(left_out)


def _stated(data: Sequence[DataSet], law: Law) -> set[str]:
    """Parameters of the law that every data set states."""
    declared = set(law.parameter_declarations)
    return declared.intersection(*(set(found.statements) for found in data))


def check_names(law: Law, fitted: Sequence[str], fixed: Sequence[str]) -> None:
    """Raise InputError for a name that is no parameter of the law, or is both to be fitted and fixed."""
    declared = law.parameter_declarations
    for name in (*fitted, *fixed):
        if name not in declared:
            raise InputError(f"{law.name} has no parameter '{name}'; {nearest_name(name, declared)}")
    for name in fitted:
        if name in fixed:
            raise InputError(f"'{name}' is both to be fitted and fixed")


def _solved(
    model: ForwardModel,
    chosen: tuple[Coordinate, ...],
    start: Values,
    without_effect: tuple[str, ...],
    left_out: tuple[str, ...],
) -> ElementFit:
    def residuals(point: Array) -> Array:
        try:
            return model.residuals(values_at(chosen, point, start))
        except (InputError, SimulationError):
            # Least squares then tries a shorter step.
            return np.full(size, np.nan)

    def jacobian(point: Array) -> Array:
        return _jacobian(model, chosen, point, start, residuals(point))

    size = model.residuals(start).size
    bounds = bounds_of(chosen)
    found = least_squares(
        residuals,
        off_bounds(coordinates_of(chosen, start), bounds, DIFFERENCE),
        jac=jacobian,
        bounds=bounds,
        x_scale="jac",
        ftol=TOLERANCE,
        max_nfev=200,
    )
    return ElementFit(
        law=model.law,
        sources=tuple(found.label for found in model.data),
        knows_errors=model.knows_errors,
        model=model,
        coordinates=chosen,
        solution=found.x,
        start=start,
        values=values_at(chosen, found.x, start),
        residuals=found.fun,
        jacobian=found.jac,
        without_effect=without_effect,
        left_out=left_out,
        converged=found.status > 0,
    )


def _jacobian(
    model: ForwardModel, chosen: tuple[Coordinate, ...], point: Array, start: Values, residuals: Array
) -> Array:
    """Central differences, one-sided where the law refuses the other side."""
    columns = []
    for index, found in enumerate(chosen):
        sides = []
        for step in (-DIFFERENCE, DIFFERENCE):
            moved = point.copy()
            moved[index] += step
            try:
                sides.append((step, model.residuals(values_at(chosen, moved, start))))
            except (InputError, SimulationError):
                continue
        if not sides:
            at = f"{found.name} = {found.value(float(point[index])):g}"
            raise SimulationError(
                f"the fit runs to {at}, beside which {model.law.name} cannot follow the tests; fix it"
            )
        if len(sides) == 1:
            sides.append((0.0, residuals))
        (first, below), (second, above) = sides
        columns.append((above - below) / (second - first))
    return np.array(columns).T
