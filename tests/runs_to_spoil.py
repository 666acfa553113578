"""Good folders of runs to spoil: their tables, frames and checkpoints."""

from collections.abc import Callable
from pathlib import Path
from unittest import mock

import numpy as np
from scenes_for_tests import BLOCK
from scenes_to_spoil import scene_file

from grainlaw.mpm_core import Scene, simulation
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.output.checkpoint import (
    CHECKPOINT_NAME,
    Clock,
    how_to_go_on,
    read_checkpoint,
    refuse_other_laws,
    write_checkpoint,
)
from grainlaw.mpm_core.output.frame import Field, Frame
from grainlaw.mpm_core.output.frame_series import FrameSeries
from grainlaw.mpm_core.output.hdf5_file import USER_BLOCK
from grainlaw.mpm_core.output.history import HistoryWriter, history_columns
from grainlaw.mpm_core.output.prepare import cut_vtkhdf
from grainlaw.mpm_core.output.quantities import write_quantities
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.summary import FinalState, RunSummary, write_summary
from grainlaw.mpm_core.output.vtkhdf import VTKHDF_NAME, append_frame

PLACES = np.array([[x, y, 0.0] for y in (0.2, 0.6) for x in (0.3, 0.5, 0.7)])
RUN_FILES = ("scene.toml", "summary.json", "history.csv", "quantities.csv", "run.pvd", "points_000000.vtu")
SUMMARY = RunSummary(
    **dict.fromkeys(("scene", "material", "version"), "a"),
    **dict.fromkeys(("points", "cells", "steps", "peak_memory_bytes", "threads"), 1),
    **dict.fromkeys(("simulated_time", "wall_time", "compile_time", "point_steps_per_second"), 1.0),
    mass_left=0.0,
    points_left=0,
    final=FinalState(runout=0.1, height=0.1, center_of_mass_height=0.05, kinetic_energy=0.0),
    energy_balance_error=0.01,
    limited={"points_at_a_wall": 1},
)


def run_file(spoils: str) -> Callable[[Path], Path]:
    """The folder of a finished run, of which one file is to be spoilt."""

    def write(folder: Path) -> Path:
        scene_file(BLOCK)(folder)
        frames, history = FrameSeries(folder), HistoryWriter(folder)
        for step in range(2):
            frames.write(_frame(step))
            history.append({column.name: step for column in history_columns()})
        write_quantities(folder, _frame(0).fields)
        write_summary(folder, SUMMARY)
        return folder / spoils

    return write


def read_run(path: Path) -> object:
    """All parts of a run's folder."""
    run_folder = RunFolder(path.parent)
    parts = run_folder.scene, run_folder.summary, run_folder.history["t"], run_folder.frame_times
    return [*parts, *(run_folder.load_frame(number).field("pressure") for number in range(len(run_folder.frame_files)))]


def _simulation() -> simulation.Simulation:
    """A block of a few points, whose kernels are not compiled."""
    with mock.patch.object(Body, "choose_kernels"), mock.patch.object(simulation, "elastic_energy", return_value=0.0):
        return simulation.Simulation(Scene.from_dict(BLOCK), 1)


def checkpoint_file(*, sealed: bool) -> Callable[[Path], Path]:
    """A writer of a checkpoint, with its checksum or as before there was one."""

    def write(folder: Path) -> Path:
        write_checkpoint(folder, _simulation(), Clock())
        path = folder / CHECKPOINT_NAME
        if not sealed:
            path.write_bytes(path.read_bytes()[USER_BLOCK:])
        return path

    return write


def read_state(path: Path) -> object:
    """What `--resume` asks of a checkpoint, and what it reads."""
    built = _simulation()
    refuse_other_laws(path.parent, [body.law for body in built.bodies])
    return how_to_go_on(path.parent), read_checkpoint(path.parent, built)


def _frame(step: int) -> Frame:
    fields = (Field("pressure", "Pa", "mean pressure", np.arange(6.0)),)
    return Frame(0.1 * step, step, PLACES, fields)


def vtkhdf_file(folder: Path) -> Path:
    """All frames in one file."""
    for step in range(3):
        append_frame(folder / VTKHDF_NAME, _frame(step))
    return folder / VTKHDF_NAME


def resume_vtkhdf(path: Path) -> None:
    """Cut the frames off and go on, as `--resume` does without VTU frames."""
    cut_vtkhdf(path, 0.1)
    append_frame(path, _frame(2))
