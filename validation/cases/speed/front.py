"""Errors over processor time, and the settings that nothing beats."""

import math
from collections.abc import Iterable, Mapping
from statistics import mean
from typing import TypeVar

from grainlaw.validation.cases.speed.setting import OBSERVABLES, Outcome

AnySetting = TypeVar("AnySetting")


def mean_observables(outcomes: Iterable[Outcome | None]) -> dict[str, float]:
    """What errors are counted against; NaN if one of the runs broke down."""
    found = [{} if outcome is None else outcome.observables for outcome in outcomes]
    return {name: mean(one.get(name, math.nan) for one in found) for name in OBSERVABLES}


def error(outcome: Outcome | None, exact: Mapping[str, float]) -> float:
    """The largest relative difference of the observables; NaN for a run that broke down."""
    if outcome is None:
        return math.nan
    return max(abs(value / exact[name] - 1.0) for name, value in outcome.observables.items())


def pareto_front(costs_and_errors: Mapping[AnySetting, tuple[float, float]]) -> list[tuple[AnySetting, float, float]]:
    """(setting, processor time [s], error) of the settings that no cheaper one is as good as, cheap ones first."""
    front: list[tuple[AnySetting, float, float]] = []
    for setting, (cost, size) in sorted(costs_and_errors.items(), key=lambda item: item[1]):
        if not front or size < front[-1][2]:
            front.append((setting, cost, size))
    return front
