"""Draws of parameters from what a calibration left open.

A draw is u = u_0 + L z, with u_0 the estimate in the coordinates of the calibration (x, or ln x), L L^T the covariance
and z normal; where the scatter of the data had to tell their errors, times sqrt(f/chi^2_f) with f degrees of freedom,
as in Student's distribution. A draw that the law refuses, for the bounds of a parameter or for what contradicts one
another, is drawn again. Parameters that were not fitted, or not determined, stay at their values.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, Law
from grainlaw.materials.calibration.parameter_file import Calibrated

Array = NDArray[np.float64]

# So many refused draws for each wanted one, and an estimate lies too near to a bound to be drawn from.
MOST_REFUSED = 20


@dataclass(frozen=True)
class Draws:
    """Drawn values by name, of all parameters of the law, and how many draws the law refused on the way."""

    values: tuple[dict[str, float], ...]
    refused: int


def drawn(calibrated: Calibrated, samples: int, seed: int) -> Draws:
    """So many draws; those of fewer samples with the same seed come first.

    Raises InputError for fewer than one sample, a negative seed, and where the law refuses nearly all draws.
    """
    if samples < 1:
        raise InputError(f"samples = {samples}; allowed: 1 or more")
    if seed < 0:
        raise InputError(f"seed = {seed}; allowed: 0 or more")
    random, factor = np.random.default_rng(seed), _square_root(np.array(calibrated.table.covariance))
    found: list[dict[str, float]] = []
    refused = 0
    while len(found) < samples:
        values = _one_draw(calibrated, factor, random)
        if allows(calibrated.law, values):
            found.append(values)
            continue
        refused += 1
        if refused > MOST_REFUSED * samples:
            raise InputError(
                f"{calibrated.source}: {calibrated.law.name} refuses {refused} of {refused + len(found)} draws: the "
                f"estimates of {', '.join(calibrated.table.drawn)} lie at their bounds; fix one of them and calibrate "
                "again"
            )
    return Draws(tuple(found), refused)


def _square_root(covariance: Array) -> Array:
    """L with L L^T the covariance; by its eigenvectors, as combinations may be known exactly."""
    deviations = np.sqrt(np.diag(covariance))
    scale = np.where(deviations > 0.0, deviations, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))


def _one_draw(calibrated: Calibrated, factor: Array, random: np.random.Generator) -> dict[str, float]:
    table = calibrated.table
    moves = factor @ random.normal(size=len(table.drawn))
    if table.degrees_of_freedom is not None:
        moves = moves * np.sqrt(table.degrees_of_freedom / random.chisquare(table.degrees_of_freedom))
    values = dict(calibrated.values)
    for name, logarithmic, move in zip(table.drawn, table.logarithmic, moves.tolist(), strict=True):
        values[name] = float(values[name] * np.exp(move)) if logarithmic else values[name] + move
    return values


def allows(law: Law, values: dict[str, float]) -> bool:
    """Whether a law takes these values of its parameters, by name."""
    try:
        law.checked(values, law.name)
    except InputError:
        return False
    return True
