"""Which runs a sweep makes: a grid, a Latin hypercube, a Sobol design, or draws from a calibration."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, product
from pathlib import Path
from typing import Any, Literal

from grainlaw.materials import InputError
from grainlaw.studies.variation import Variation

Kind = Literal["grid", "hypercube", "sobol", "draws"]
# More are a slip.
MOST_RUNS = 100_000
# Of values of other keys with which one is tried.
MOST_TRIED = 64


@dataclass(frozen=True)
class Design:
    """The keys that a sweep varies, and their values in each run, in the order of the runs."""

    kind: Kind
    keys: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]

    def changes(self) -> list[dict[str, Any]]:
        """The values of each run by key."""
        return [dict(zip(self.keys, row, strict=True)) for row in self.rows]


def grid_design(variations: Sequence[Variation]) -> Design:
    """All combinations of the values, the last key fastest. Raises InputError where a range says no number of them."""
    for variation in variations:
        if not variation.levels:
            raise InputError(f"--vary {variation.text}: a grid needs a:b:n; a:b goes with --samples")
    _refuse_too_many(math.prod(len(variation.levels) for variation in variations))
    rows = tuple(product(*(variation.levels for variation in variations)))
    return Design("grid", _keys(variations), rows)


def hypercube_design(variations: Sequence[Variation], samples: int, seed: int) -> Design:
    """A Latin hypercube: each n-th part of each range holds one run. Raises InputError for ranges with a number."""
    from scipy.stats import qmc

    _refuse_grids(variations)
    _refuse_too_many(samples)
    shares = qmc.LatinHypercube(len(variations), rng=seed).random(samples)
    return _placed("hypercube", variations, shares)


def sobol_design(variations: Sequence[Variation], samples: int, seed: int) -> Design:
    """Saltelli's design, samples (d + 2) runs for d keys, from which Sobol indices follow (Saltelli et al. 2010).

    Raises InputError where samples is no power of two, as the sequence needs it, and for ranges with a number.
    """
    from SALib.sample import sobol as saltelli

    _refuse_grids(variations)
    if samples & (samples - 1):
        lower = 1 << (samples.bit_length() - 1)
        raise InputError(f"samples = {samples}: a Sobol design takes a power of two; nearest: {lower} or {2 * lower}")
    _refuse_too_many(samples * (len(variations) + 2))
    shares = saltelli.sample(problem(_keys(variations)), samples, calc_second_order=False, seed=seed)
    return _placed("sobol", variations, shares)


def drawn_design(content: Mapping[str, Any], parameters: Path, samples: int, seed: int) -> Design:
    """Draws from what a calibration left open, for the materials of a scene with its law.

    Raises InputError for a file that holds no calibration, and where no material has its law.
    """
    from grainlaw.materials.calibration.parameter_file import read_calibrated
    from grainlaw.studies.draws import drawn

    calibrated = read_calibrated(parameters)
    _refuse_too_many(samples)
    law, tables = calibrated.law.name, content.get("material")
    names = [name for name, table in (tables or {}).items() if str(table.get("law", name)) == law]
    if not names:
        raise InputError(f"{parameters} is of the law {law}, which no material of the scene has")
    keys = tuple(f"material.{name}.{parameter}" for name in names for parameter in calibrated.table.drawn)
    found = drawn(calibrated, samples, seed).values
    rows = tuple(tuple(values[key.rpartition(".")[2]] for key in keys) for values in found)
    return Design("draws", keys, rows)


def problem(keys: Sequence[str]) -> dict[str, Any]:
    """The keys as SALib knows them, each over its share from 0 to 1."""
    return {"num_vars": len(keys), "names": list(keys), "bounds": [[0.0, 1.0]] * len(keys)}


def refuse_bad_values(variations: Sequence[Variation], check: Callable[[Mapping[str, Any]], None]) -> None:
    """Raises the InputError of `check` for a value that is refused with every value of the other keys.

    A combination that alone is refused is a run that fails.
    """
    for number, variation in enumerate(variations):
        others = [*variations[:number], *variations[number + 1 :]]
        for value in variation.ends:
            combinations = islice(product(*(other.ends for other in others)), MOST_TRIED)
            tried = ({variation.key: value, **_named(others, values)} for values in combinations)
            _refuse_if_all_fail(tried, check)


def _refuse_if_all_fail(tried: Any, check: Callable[[Mapping[str, Any]], None]) -> None:
    first: InputError | None = None
    for changes in tried:
        try:
            check(changes)
            return
        except InputError as error:
            first = first or error
    if first is not None:
        raise first


def _named(variations: Sequence[Variation], values: Sequence[Any]) -> dict[str, Any]:
    return {variation.key: value for variation, value in zip(variations, values, strict=True)}


def _keys(variations: Sequence[Variation]) -> tuple[str, ...]:
    return tuple(variation.key for variation in variations)


def _placed(kind: Kind, variations: Sequence[Variation], shares: Any) -> Design:
    rows = tuple(tuple(map(Variation.at, variations, row)) for row in shares.tolist())
    return Design(kind, _keys(variations), rows)


def _refuse_grids(variations: Sequence[Variation]) -> None:
    for variation in variations:
        if variation.bounds is not None and variation.levels:
            raise InputError(f"--vary {variation.text}: with samples a range is a:b, without a number of values")


def _refuse_too_many(runs: int) -> None:
    if runs > MOST_RUNS:
        raise InputError(f"the sweep has {runs} runs; allowed: {MOST_RUNS} or fewer")
