"""A run's folder made ready for a run: a new one, one in the place of another, or one that goes on."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from grainlaw.materials import InputError, atomic
from grainlaw.mpm_core.output.checkpoint import CHECKPOINT_NAME, Clock, read_checkpoint
from grainlaw.mpm_core.output.folder_lock import held
from grainlaw.mpm_core.output.forces import FORCES_NAME
from grainlaw.mpm_core.output.frame_series import COLLECTION_NAME, FrameSeries
from grainlaw.mpm_core.output.hdf5_reading import UNREADABLE
from grainlaw.mpm_core.output.history import HISTORY_NAME
from grainlaw.mpm_core.output.obstacle_series import OBSTACLES_NAME, ObstacleSeries
from grainlaw.mpm_core.output.quantities import QUANTITIES_NAME
from grainlaw.mpm_core.output.rows import keep_rows
from grainlaw.mpm_core.output.run_folder import SCENE_NAME, RunFolder
from grainlaw.mpm_core.output.summary import SUMMARY_NAME
from grainlaw.mpm_core.output.vtkhdf import VTKHDF_NAME, append_frame, drop_after
from grainlaw.mpm_core.simulation import Simulation

OF_THE_END = (SUMMARY_NAME, "final.png", "history.png", "snapshots.png", "forces.png", "movie.mp4", "view.html")
OWN_FILES = (
    SCENE_NAME,
    VTKHDF_NAME,
    CHECKPOINT_NAME,
    COLLECTION_NAME,
    HISTORY_NAME,
    FORCES_NAME,
    OBSTACLES_NAME,
    "obstacle_*.vtp",
    QUANTITIES_NAME,
    "points_*.vtu",
    *OF_THE_END,
)


@contextmanager
def new_folder(folder: Path, scene_text: str, *, overwrite: bool) -> Iterator[None]:
    """Make a folder ready for a run from its beginning, and hold it.

    Raises InputError where that would lose another run, and where the folder cannot be written.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError(f"output folder {folder} is a file")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"output folder {folder} cannot be written: {error.strerror}") from error
    with held(folder):
        if not overwrite and any(any(folder.glob(pattern)) for pattern in OWN_FILES):
            raise InputError(f"{folder} already holds a run; choose another --out, --resume it or --overwrite it")
        _remove(folder, OWN_FILES)
        try:
            atomic.write_text(folder / SCENE_NAME, scene_text)
        except OSError as error:
            raise InputError(f"output folder {folder} cannot be written: {error.strerror}") from error
        yield


def go_on(folder: Path, simulation: Simulation) -> Clock:
    """Bring a simulation to the checkpoint of a folder that is held, and drop what was written after that.

    Raises InputError for a checkpoint or a file that cannot be read, or belongs to another scene or law.
    """
    clock = read_checkpoint(folder, simulation)
    keep_rows(folder / HISTORY_NAME, clock.history_rows)
    if simulation.obstacles.all:
        keep_rows(folder / FORCES_NAME, clock.history_rows)
        ObstacleSeries(folder, simulation).drop_after(simulation.time)
    if simulation.scene.output.vtu:
        FrameSeries(folder).drop_after(simulation.time)
    if simulation.scene.output.vtkhdf:
        _rewind_vtkhdf(folder, simulation)
    _remove(folder, OF_THE_END)
    atomic.write_text(folder / SCENE_NAME, simulation.scene.to_toml())
    return clock


def _remove(folder: Path, patterns: tuple[str, ...]) -> None:
    for pattern in patterns:
        for path in folder.glob(pattern):
            path.unlink()


def _rewind_vtkhdf(folder: Path, simulation: Simulation) -> None:
    """Write run.vtkhdf anew from the VTU frames, or else from itself: a killed run may have left it damaged."""
    path = folder / VTKHDF_NAME
    if simulation.scene.output.vtu:
        path.unlink(missing_ok=True)
        frames = RunFolder(folder)
        for index in range(len(frames.frame_files)):
            append_frame(path, frames.load_frame(index))
        return
    cut_vtkhdf(path, simulation.time)


def cut_vtkhdf(path: Path, time: float) -> None:
    """Drop the frames after `time` [s]. Raises InputError for a damaged file, and OSError for one that is not open."""
    try:
        drop_after(path, time)
    except (*UNREADABLE, InputError) as error:
        if isinstance(error, OSError) and error.errno:
            raise
        raise InputError(f"{path} was damaged when the run was stopped; --overwrite starts the run again") from error
