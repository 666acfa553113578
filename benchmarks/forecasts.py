"""What `grainlaw plan` says of a scene, beside what its run then takes."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.scene.shipped import shipped_scenes
from grainlaw.mpm_core.stepping.plan import plan
from grainlaw.mpm_core.stepping.run import run

# Shipped scenes, on cells that make a run take seconds.
SCENES: dict[str, dict[str, Any]] = {
    "collapse_mu_i_lc": {"grid.cell_size": 0.0125},
    "collapse_mcc_ocr1": {"grid.cell_size": 0.0125},
    "collapse_mcc_ocr4": {"grid.cell_size": 0.0125},
    "heap": {"time.end": 0.5},
    "incline": {},
    "sliding_block": {"grid.cell_size": 0.0125},
    "two_discs": {"grid.cell_size": 0.025},
}
QUICK_SCENES: dict[str, dict[str, Any]] = {"sliding_block": {"time.end": 0.1}}


@dataclass(frozen=True)
class Forecast:
    """Predicted and actual number of steps, predicted and actual wall time [s], and processor time [s] of the run."""

    scene: str
    points: int
    predicted_steps: int
    steps: int
    predicted_time: float
    time: float
    cpu_time: float


def forecasts(scenes: Mapping[str, Mapping[str, Any]], threads: int = 1) -> list[Forecast]:
    """Plan and then run each scene."""
    return [_forecast(name, dict(changes), threads) for name, changes in scenes.items()]


def _forecast(name: str, changes: dict[str, Any], threads: int) -> Forecast:
    scene = Scene.load(shipped_scenes()[name], {**changes, "output.pictures": False})
    planned = plan(scene, threads)
    with TemporaryDirectory() as folder:
        cpu = process_time()
        taken = run(scene, Path(folder) / name, threads=threads)
        cpu = process_time() - cpu
    return Forecast(name, taken.points, planned.steps, taken.steps, planned.wall_time, taken.wall_time, cpu)
