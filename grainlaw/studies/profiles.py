"""Profiles of grains as measurements, and a scene that answers with profiles.

Places of a profile lie so far apart that the kernel of the observation leaves them independent of one another: noise
smoothed by a Gaussian of width w keeps a correlation length of 2 sqrt(pi) w.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from grainlaw.materials import Law
from grainlaw.materials.calibration.coordinates import Array
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.studies.batch import Member, run_shown
from grainlaw.studies.ensemble import plan
from grainlaw.studies.observed import Observing
from grainlaw.validation.grains.distance import surface_at
from grainlaw.validation.grains.observation import Observation

CORRELATION = 2.0 * math.sqrt(math.pi)
RUNS = "runs"
# Parameters of the law, and values of the scene by dotted key on top, by the names of runs.
Asked = dict[str, tuple[Mapping[str, float], Mapping[str, Any]]]


@dataclass(frozen=True)
class Places:
    """Where grains and runs are compared: at a time [s], at x [m]; heights of the grains there, shape (places,)."""

    grains: Observation
    time: float
    x: Array
    heights: Array

    @property
    def size(self) -> float:
        """Root mean square of the heights [m]."""
        return math.sqrt(float(np.mean(self.heights**2)))

    def heights_of(self, run: Observation) -> Array:
        """What a run shows there."""
        return np.asarray(surface_at(run, self.time, self.x), dtype=np.float64)


def places_of(grains: Observation, width: float, end: float) -> Places:
    """Places one correlation length apart, from the axis outwards to the first beyond the material.

    Grains and runs are compared where both end first [s]; a deposit alone, at the end of the run.
    """
    time = min(end, float(grains.times[-1])) if len(grains.times) > 1 else end
    surface = surface_at(grains, time, grains.x)
    reach = float(np.abs(grains.x[surface > width]).max(initial=0.0))
    distance = CORRELATION * width
    number = math.ceil(reach / distance)
    x = distance * np.arange(0 if grains.space.hoop else -number, number + 1, dtype=np.float64)
    return Places(grains, time, x, np.asarray(surface_at(grains, time, x), dtype=np.float64))


@dataclass(frozen=True)
class ProfileModel:
    """A scene that answers with profiles; `scheduler` and `resume` are for `run_members`."""

    scene: Scene
    law: Law
    out: Path
    how: Observing
    places: tuple[Places, ...]
    scheduler: str
    resume: bool

    @property
    def size(self) -> int:
        """Number of measurements."""
        return sum(len(places.x) for places in self.places)

    def folder(self, name: str) -> Path:
        """Where a run lies."""
        return self.out / RUNS / name

    def residuals(self, asked: Asked) -> dict[str, Array]:
        """(run - grains) over the size of the grains' profile, for each of some runs; NaN for one that failed."""
        prepared = plan(self.scene, self.law)
        members = [Member(name, prepared.with_parameters(*what)) for name, what in asked.items()]
        outcomes = run_shown(members, self.out / RUNS, scheduler=self.scheduler, resume=self.resume)
        return {
            outcome.name: np.full(self.size, np.nan) if outcome.reason else self._compared(outcome.folder)
            for outcome in outcomes
        }

    def _compared(self, folder: Path) -> Array:
        run = self.how.observe(folder)
        return np.concatenate([(places.heights_of(run) - places.heights) / places.size for places in self.places])
