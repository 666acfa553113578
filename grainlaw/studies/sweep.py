"""A sweep: one scene with some of its values varied, a run for each, a table and a page of what came of them."""

import json
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from grainlaw.face.scenes import SceneSource, scene_content
from grainlaw.face.tables import data_frame
from grainlaw.materials import InputError, atomic
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.space import PLANE_STRAIN, SPACES
from grainlaw.studies.batch import Member, Outcome, run_shown
from grainlaw.studies.design import (
    Design,
    drawn_design,
    grid_design,
    hypercube_design,
    refuse_bad_values,
    sobol_design,
)
from grainlaw.studies.sweep_page import PAGE_NAME, page_of
from grainlaw.studies.table import swept, units, write_tables
from grainlaw.studies.variation import Given, Variation, variations_of

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True)
class Sweep:
    """What a sweep left in its folder: the design, what became of each run, and the table of all, one row per run."""

    folder: Path
    design: Design
    outcomes: tuple[Outcome, ...]
    table: pa.Table
    files: tuple[Path, ...]

    @property
    def failed(self) -> tuple[Outcome, ...]:
        """The runs that failed, each with its reason."""
        return tuple(outcome for outcome in self.outcomes if outcome.reason)

    @property
    def units(self) -> dict[str, str]:
        """The SI unit of each column that has one."""
        return units(self.table)

    def to_frame(self) -> "DataFrame":
        """The table in pandas, with the units in its `attrs`. Raises InputError without pandas."""
        columns = {name: np.array(self.table[name].to_pylist()) for name in self.table.column_names}
        return data_frame(columns, self.units)

    def __repr__(self) -> str:
        return f"Sweep({str(self.folder)!r}): {len(self.outcomes)} runs, {len(self.failed)} failed"


def sweep(
    scene: SceneSource,
    out: str | Path,
    vary: Mapping[str, Given] | None = None,
    *,
    samples: int | None = None,
    parameters: str | Path | None = None,
    sobol: bool = False,
    seed: int = 0,
    changes: Mapping[str, Any] | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    resume: bool = False,
) -> Sweep:
    """Run a scene for each combination of varied values; write a folder for each, sweep.csv, .parquet and .html.

    scene       tables, the path of a TOML file, the name of a shipped scene, or a Scene
    out         folder of all runs
    vary        by dotted key "a:b:n" for n values from a to b, "a:b" with samples, or a list of values
    samples     so many runs of a Latin hypercube over the ranges, or draws from `parameters`
    parameters  the file that `grainlaw calibrate` wrote: draws from its estimate and covariance
    sobol       samples (keys + 2) runs instead, from which Sobol indices follow
    seed        of hypercubes, Sobol designs and draws
    changes     values by dotted key set on top of the scene
    scheduler   address of a Dask scheduler; by default processes here
    workers     how many processes here; by default the cores
    resume      leave finished runs alone, go on with the others

    A run that fails is a row with its reason. Raises InputError, before anything is run, for a key or value that the
    scene refuses, an empty range, a folder that holds other runs, and a scheduler that does not answer within 10 s.
    """
    content, name = scene_content(scene, changes or {})
    asked = _Asked(scene, changes or {}, name)
    variations = variations_of(vary or {})
    design = _designed(content, variations, samples, parameters, sobol, seed)
    for key in asked.changes:
        if key in design.keys:
            raise InputError(f"{key} is both set and varied; choose one")
    refuse_bad_values(variations, asked.check)
    members = _members(design, asked)
    folder = Path(out)
    outcomes = run_shown(members, folder, scheduler=scheduler, workers=workers, resume=resume)
    table = swept(design, outcomes, SPACES[str(content.get("space", PLANE_STRAIN.name))])
    command = _command(asked, variations, samples, parameters, sobol)
    files = [*write_tables(table, folder), folder / PAGE_NAME]
    atomic.write_text(files[-1], page_of(design, table, name, command).html())
    return Sweep(folder, design, tuple(outcomes), table, tuple(files))


@dataclass(frozen=True)
class _Asked:
    """The scene with what is the same in all runs, and what it is called."""

    source: SceneSource
    changes: Mapping[str, Any]
    name: str

    def content(self, varied: Mapping[str, Any]) -> dict[str, Any]:
        """The tables of a run. Files that are varied count from the scene's file, too."""
        try:
            return scene_content(self.source, {**self.changes, **varied})[0]
        except InputError as error:
            raise InputError(str(error).replace("--set", "--vary", 1)) from error

    def check(self, varied: Mapping[str, Any]) -> None:
        """Raises InputError where the scene refuses these values."""
        Scene.from_dict(self.content(varied), self.name)


def _designed(
    content: Mapping[str, Any],
    variations: Sequence[Variation],
    samples: int | None,
    parameters: str | Path | None,
    sobol: bool,
    seed: int,
) -> Design:
    if samples is not None and samples < 1:
        raise InputError(f"samples = {samples}; allowed: 1 or more")
    if seed < 0:
        raise InputError(f"seed = {seed}; allowed: 0 or more")
    if parameters is not None:
        if variations or sobol or samples is None:
            raise InputError(f"draws from {parameters} take a number of samples, and neither --vary nor --sobol")
        return drawn_design(content, Path(parameters), samples, seed)
    if not variations:
        raise InputError("nothing is varied: a sweep takes --vary KEY=a:b:n, or --from parameters.toml --samples N")
    if samples is None:
        if sobol:
            raise InputError("--sobol takes --samples N, a power of two")
        return grid_design(variations)
    return (sobol_design if sobol else hypercube_design)(variations, samples, seed)


def _members(design: Design, asked: _Asked) -> list[Member]:
    """The runs, called by their numbers, all with as many digits."""
    width = len(str(max(len(design.rows) - 1, 99)))
    return [Member(f"{n:0{width}d}", asked.content(varied)) for n, varied in enumerate(design.changes())]


def _command(
    asked: _Asked, variations: Sequence[Variation], samples: int | None, parameters: str | Path | None, sobol: bool
) -> str:
    """What was asked, as a command; for the page."""
    words = ["grainlaw", "sweep", asked.name]
    for key, value in asked.changes.items():
        words += ["--set", f"{key}={json.dumps(value, default=str)}"]
    for variation in variations:
        words += ["--vary", variation.text]
    if parameters is not None:
        words += ["--from", str(parameters)]
    if samples is not None:
        words += ["--samples", str(samples)]
    return shlex.join([*words, *(["--sobol"] if sobol else [])])
