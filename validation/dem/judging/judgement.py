"""Laws run on the columns of the grains and compared with them; runs that are there already are not repeated."""

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from grainlaw.materials import InputError, SimulationError, get_material
from grainlaw.materials.compilation import pointwise_law
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.validation.dem.judging.column import ROUGH_FRICTION, Column, column_of, column_scene, observed_column
from grainlaw.validation.dem.judging.fitted_laws import FittedLaw
from grainlaw.validation.dem.judging.variants import Variant, varied
from grainlaw.validation.grains.distance import Comparison, Verdict, compare
from grainlaw.validation.grains.observation import Observation, is_observation, read_observation, write_observation
from grainlaw.validation.reference.reference_set import Ensemble, ReferenceSet

RUNS = "runs"
Announce = Callable[[str], None]


@dataclass(frozen=True)
class Judgement:
    """A law, or a variant of it, on one column: what was observed and how far it is from the grains.

    `failure` says what kept it from being run.
    """

    name: str
    ensemble: Ensemble
    observation: Observation | None
    comparison: Comparison | None
    failure: str = ""
    variant: Variant | None = None

    @property
    def verdict(self) -> Verdict:
        """The verdict; what breaks down differs."""
        return Verdict.DIFFERS if self.comparison is None else self.comparison.verdict


@dataclass(frozen=True)
class Bench:
    """Where and how finely laws are run: the folder of the report, the cell size [m], and who is told of each run."""

    folder: Path
    cell_size: float
    announce: Announce = field(default=lambda text: None)

    def judge(self, law: FittedLaw, ensemble: Ensemble, floor_friction: float = ROUGH_FRICTION) -> Judgement:
        """A law on a column of grains, above a floor with this friction."""
        column = column_of(ensemble, floor_friction)
        scene = column_scene(column, law.judged.law, law.parameters, self.cell_size)
        return self._judged(law.judged.title, scene, column, ensemble, law.judged.law)

    def judge_variant(self, law: FittedLaw, reference: ReferenceSet, ensemble: Ensemble, variant: Variant) -> Judgement:
        """The column of a law with one thing changed, against the grains that the variant names."""
        try:
            ensemble = reference.ensemble(ensemble.case.replace(ensemble.floor, variant.grains))
        except InputError as error:
            return Judgement(variant.name, ensemble, None, None, str(error), variant)
        column = column_of(ensemble)
        cell_size = self.cell_size * variant.cell_factor
        scene = varied(column_scene(column, law.judged.law, law.parameters, cell_size), law.judged.law, variant)
        return self._judged(variant.name, scene, column, ensemble, law.judged.law, variant)

    def _judged(
        self,
        name: str,
        scene: dict[str, Any],
        column: Column,
        ensemble: Ensemble,
        law: str,
        variant: Variant | None = None,
    ) -> Judgement:
        try:
            observation = self._observation(name, scene, column, law)
        except (InputError, SimulationError) as error:
            return Judgement(name, ensemble, None, None, str(error), variant)
        return Judgement(name, ensemble, observation, compare(observation, ensemble.runs), variant=variant)

    def _observation(self, name: str, scene: dict[str, Any], column: Column, law: str) -> Observation:
        """The run of a scene; from the folder if the scene and every source behind it are still the same."""
        sources = [CORE_MARK, pointwise_law(get_material(law)).mark]
        key = hashlib.sha256(json.dumps([scene, column.times, sources], sort_keys=True).encode()).hexdigest()[:16]
        path = self.folder / RUNS / f"{law}_{key}.h5"
        if path.is_file() and is_observation(path):
            return read_observation(path)
        shape = "cylinder" if column.space.hoop else "column"
        self.announce(f"{name}, {shape} {column.height:.2f} m high, cells of {scene['grid']['cell_size'] * 1e3:g} mm")
        observation = observed_column(scene, column, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_observation(path, observation)
        return observation
