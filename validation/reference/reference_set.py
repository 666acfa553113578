"""The reference set: observations of DEM collapses, and shear and compression of the same grains."""

import csv
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from grainlaw.materials import InputError
from grainlaw.materials.errors import nearest_name
from grainlaw.mpm_core.space import AXISYMMETRIC, PLANE_STRAIN, Space
from grainlaw.validation.grains.distance import Comparison, compare
from grainlaw.validation.grains.observation import Observation, read_observation

REFERENCE = Path(__file__).resolve().parent
COLLAPSES = "collapse"
Rows = list[dict[str, float]]


@dataclass(frozen=True)
class Ensemble:
    """All runs of one case: the same column with other packings and by other codes."""

    case: str
    runs: tuple[Observation, ...]

    @property
    def aspect_ratio(self) -> float:
        """H0 over the half width, or the radius."""
        return self._of_description("initial_height") / self.half_width

    @property
    def half_width(self) -> float:
        """Half width of the column, or radius of the cylinder [m]."""
        return self._of_description("half_width")

    @property
    def space(self) -> Space:
        """Plane strain, or axisymmetry for a cylinder."""
        return self.runs[0].space

    @property
    def kind(self) -> str:
        """What the case is, in a word."""
        return "cylinder" if self.space.hoop else "column"

    @property
    def title(self) -> str:
        """The aspect ratio, and that it is no plane column, if so."""
        return f"a = {self.aspect_ratio:g}{', cylinder' if self.space.hoop else ''}"

    @property
    def floor(self) -> str:
        """Kind of the floor."""
        return str(self.runs[0].description.get("floor", ""))

    @property
    def end(self) -> float:
        """The time that all runs reach [s]."""
        return float(min(run.times[-1] for run in self.runs))

    def _of_description(self, key: str) -> float:
        value = self.runs[0].description.get(key)
        if not isinstance(value, int | float):
            raise InputError(f"{self.case}: the description of {self.runs[0].label} has no number '{key}'")
        return float(value)


@dataclass(frozen=True)
class ReferenceSet:
    """Ensembles by case, and the rows of the element tests of the grains, by the name of their table."""

    ensembles: dict[str, Ensemble]
    tests: dict[str, Rows]

    def ensemble(self, case: str) -> Ensemble:
        """The runs of a case. Raises InputError for a case that is not there."""
        if case not in self.ensembles:
            raise InputError(f"the reference set has no case '{case}'; {nearest_name(case, self.ensembles)}")
        return self.ensembles[case]

    def test(self, name: str) -> Rows:
        """The rows of an element test; none if it is not there."""
        return self.tests.get(name, [])

    def columns(self, floor: str) -> list[Ensemble]:
        """The plain columns on a floor, in plane strain, from the squat to the slender."""
        return self._on(floor, PLANE_STRAIN)

    def cylinders(self, floor: str) -> list[Ensemble]:
        """The cylinders on a floor, from the squat to the slender."""
        return self._on(floor, AXISYMMETRIC)

    def _on(self, floor: str, space: Space) -> list[Ensemble]:
        plain = [one for one in self.ensembles.values() if one.case.endswith(f"-{floor}") and one.space is space]
        return sorted(plain, key=lambda found: found.aspect_ratio)


def read_reference_set(folder: Path = REFERENCE) -> ReferenceSet:
    """Read the reference set. Raises InputError if a part is missing or damaged."""
    paths = sorted((folder / COLLAPSES).rglob("*.h5"))
    if not paths:
        raise InputError(f"{folder / COLLAPSES} holds no observations; the reference set comes with a checkout")
    by_case: dict[str, list[Observation]] = {}
    for path in paths:
        observation = read_observation(path)
        by_case.setdefault(str(observation.description.get("case", "")), []).append(observation)
    ensembles = {case: Ensemble(case, tuple(runs)) for case, runs in by_case.items()}
    return ReferenceSet(ensembles, {path.stem: _rows(path) for path in sorted(folder.glob("*.csv"))})


def _rows(path: Path) -> Rows:
    """The numbers of a table with a header; columns of text are left out."""
    with path.open(encoding="utf-8", newline="") as file:
        lines = [line for line in file if not line.startswith("#")]
    return [{name: float(text) for name, text in row.items() if _is_number(text)} for row in csv.DictReader(lines)]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except (TypeError, ValueError):
        return False
    return True


@dataclass(frozen=True)
class Scatter:
    """How far runs of DEM are from one another: what of, and a comparison for each pair."""

    kind: str
    case: str
    pairs: tuple[Comparison, ...]

    def largest(self, number: int) -> float:
        """The largest distance of the pairs in one measure."""
        return max(abs(pair.distances[number].distance) for pair in self.pairs)

    def mean(self, number: int) -> float:
        """The mean distance of the pairs in one measure."""
        return float(np.mean([abs(pair.distances[number].distance) for pair in self.pairs]))


def scatter(reference: ReferenceSet) -> list[Scatter]:
    """Seed against seed and code against code on each column, flat against glued floor, variants against the column."""
    found = []
    for ensemble in reference.ensembles.values():
        pairs = list(combinations(ensemble.runs, 2))
        same = [(one, other) for one, other in pairs if _code(one) == _code(other)]
        across = [(one, other) for one, other in pairs if _code(one) != _code(other)]
        found += [
            _scatter("seed against seed", ensemble.case, same),
            _scatter("code against code", ensemble.case, across),
        ]
        base = reference.ensembles.get(ensemble.case.rpartition("-")[0])
        if base is not None:
            packings = [(one, other) for one in ensemble.runs for other in base.runs if _code(one) == _code(other)]
            found.append(_scatter("against the plain column", ensemble.case, packings))
        flat = reference.ensembles.get(ensemble.case.replace("glued", "flat"))
        if flat is not None and flat is not ensemble:
            floors = [(one, other) for one in flat.runs for other in ensemble.runs if _code(one) == _code(other)]
            found.append(_scatter("flat against glued floor", ensemble.case, floors))
    return [one for one in found if one.pairs]


def _scatter(kind: str, case: str, pairs: list[tuple[Observation, Observation]]) -> Scatter:
    return Scatter(kind, case, tuple(compare(one, [other]) for one, other in pairs))


def _code(observation: Observation) -> str:
    return str(observation.description.get("code", ""))
