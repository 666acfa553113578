"""How much each key of a sweep matters: means over the others, shares of the variance, rank correlations."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from grainlaw.studies.design import Design, problem

Array = NDArray[np.float64]

CONFIDENCE = 0.95
RESAMPLES = 500
# Of the resamples, so that a page is the same each time; SALib takes zero for none.
SEED = 1
# Base samples of a Sobol design that finished, below which indices say nothing.
FEWEST_BASES = 8


@dataclass(frozen=True)
class Effect:
    """Mean, and 5 and 95 % quantiles, of a quantity over all runs with a value of a key."""

    values: tuple[Any, ...]
    mean: Array
    low: Array
    high: Array


@dataclass(frozen=True)
class Indices:
    """Sobol indices of one quantity, one per key, and the half widths of their intervals, nan where they are exact."""

    first: Array
    first_interval: Array
    total: Array
    total_interval: Array
    runs: int


def main_effect(values: Sequence[Any], result: Array) -> Effect:
    """The means of a quantity at each value of a key, over all others; runs that failed (nan) are left out."""
    levels = tuple(dict.fromkeys(values))
    at = [result[[value == level for value in values]] for level in levels]
    finished = [found[np.isfinite(found)] for found in at]
    low, mean, high = (
        np.array([statistic(found) if len(found) else np.nan for found in finished])
        for statistic in (lambda x: np.quantile(x, 0.05), np.mean, lambda x: np.quantile(x, 0.95))
    )
    return Effect(levels, mean, low, high)


def indices(design: Design, result: Array) -> Indices | None:
    """Sobol indices of a quantity over the runs of a design, in their order; None where the design allows none.

    A Sobol design: Saltelli's and Jansen's estimators (Saltelli et al. 2010), with bootstrapped 95 % intervals, over
    the base samples whose runs all finished. A full grid: the shares of its own variance, which are exact. None where
    the quantity is the same in all runs.
    """
    if design.kind == "sobol":
        return _sampled(design, result)
    if design.kind == "grid" and np.isfinite(result).all() and np.ptp(result) > 0.0:
        return _divided(design, result)
    return None


def _sampled(design: Design, result: Array) -> Indices | None:
    from SALib.analyze import sobol

    blocks = result.reshape(-1, len(design.keys) + 2)
    complete = blocks[np.isfinite(blocks).all(axis=1)]
    if len(complete) < FEWEST_BASES or np.ptp(complete) == 0.0:
        return None
    found: Mapping[str, Array] = sobol.analyze(
        problem(design.keys),
        complete.ravel(),
        calc_second_order=False,
        num_resamples=RESAMPLES,
        conf_level=CONFIDENCE,
        seed=SEED,
    )
    return Indices(found["S1"], found["S1_conf"], found["ST"], found["ST_conf"], complete.size)


def _divided(design: Design, result: Array) -> Indices:
    shape = [len({repr(row[n]) for row in design.rows}) for n in range(len(design.keys))]
    table, axes = result.reshape(shape), range(len(shape))
    others = [tuple(axis for axis in axes if axis != own) for own in axes]
    first = np.array([table.mean(axis=left).var() for left in others]) / table.var()
    total = np.array([table.var(axis=own).mean() for own in axes]) / table.var()
    exact = np.full(len(shape), np.nan)
    return Indices(first, exact, total, exact, table.size)


def rank_correlation(values: Sequence[Any], result: Array) -> float:
    """Spearman's correlation of a key and a quantity over the runs that finished; nan where it has none."""
    from scipy.stats import spearmanr

    finished = np.isfinite(result)
    if not all(isinstance(value, int | float) for value in values) or finished.sum() < 3:
        return float("nan")
    own, found = np.array(values, dtype=float)[finished], result[finished]
    return float(spearmanr(own, found).statistic) if np.ptp(own) > 0.0 and np.ptp(found) > 0.0 else float("nan")


def results_of(table: pa.Table, names: Sequence[str]) -> dict[str, Array]:
    """The columns of a table that differ between its runs, as numbers, nan where a run failed."""
    columns = {name: np.array([np.nan if x is None else x for x in table[name].to_pylist()], float) for name in names}
    return {name: column for name, column in columns.items() if _differs(column)}


def _differs(column: Array) -> bool:
    finished = column[np.isfinite(column)]
    return len(finished) > 1 and bool(np.ptp(finished) > 0.0)
