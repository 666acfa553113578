"""Writing a run's folder while the run goes on: frames, history rows, checkpoints."""

from pathlib import Path

from grainlaw.materials import InputError, atomic
from grainlaw.mpm_core.output.checkpoint import CHECKPOINT_NAME, Clock, write_checkpoint
from grainlaw.mpm_core.output.fields import make_frame
from grainlaw.mpm_core.output.frame_series import COLLECTION_NAME, FrameSeries
from grainlaw.mpm_core.output.history import HISTORY_NAME, HistoryWriter, drop_rows_after
from grainlaw.mpm_core.output.observables import PileShape, pile_shape
from grainlaw.mpm_core.output.quantities import QUANTITIES_NAME, write_quantities
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.summary import SUMMARY_NAME
from grainlaw.mpm_core.output.vtkhdf import VTKHDF_NAME, append_frame, drop_after
from grainlaw.mpm_core.simulation import Simulation

SCENE_NAME = "scene.toml"
FRAMES_BY_DEFAULT = 30
HISTORY_ROWS_BY_DEFAULT = 300
OWN_FILES = (
    SCENE_NAME,
    VTKHDF_NAME,
    CHECKPOINT_NAME,
    COLLECTION_NAME,
    HISTORY_NAME,
    QUANTITIES_NAME,
    SUMMARY_NAME,
    "points_*.vtu",
    "final.png",
    "history.png",
    "snapshots.png",
)


class Recorder:
    """The open run folder of one simulation."""

    def __init__(self, folder: Path, simulation: Simulation, clock: Clock) -> None:
        output, end = simulation.scene.output, simulation.scene.time.end
        self.folder = folder
        self.simulation = simulation
        self.clock = clock
        self.frame_interval = output.interval or end / FRAMES_BY_DEFAULT
        self.history_interval = output.history_interval or end / HISTORY_ROWS_BY_DEFAULT
        self.series = FrameSeries(folder) if output.vtu else None
        self.history = HistoryWriter(folder)
        frame = make_frame(simulation.time, simulation.steps, simulation.bodies, simulation.fields)
        write_quantities(folder, frame.fields)

    def next_frame_time(self) -> float:
        """When the next frame is due [s]: at whole multiples of the interval and at the end."""
        due, end = self.clock.next_frame * self.frame_interval, self.simulation.scene.time.end
        # A multiple that misses the end by rounding is the end.
        return due if due < end * (1.0 - 1e-9) else end

    def shape(self) -> PileShape:
        """The present shape of the material."""
        simulation = self.simulation
        return pile_shape(simulation.bodies, simulation.grid.lower[1], simulation.grid.cell_size)

    def record(self, dt: float, wall_time: float) -> None:
        """Write whatever is due after a step of `dt` [s]."""
        simulation, clock = self.simulation, self.clock
        clock.wall_time = wall_time
        at_end = simulation.time >= simulation.scene.time.end
        if at_end or simulation.time >= clock.next_history * self.history_interval:
            self._append_history(dt, wall_time)
            clock.next_history = int(simulation.time / self.history_interval) + 1
        if simulation.time >= self.next_frame_time():
            self._write_frame()
            clock.next_frame += 1
            write_checkpoint(self.folder, simulation, clock)

    def close(self) -> None:
        """Close the history."""
        self.history.close()

    def _append_history(self, dt: float, wall_time: float) -> None:
        shape, ledger, elastic = self.shape(), self.simulation.ledger, self.simulation.elastic_energy()
        self.history.append(
            {
                "t": self.simulation.time,
                "dt": dt,
                "runout": shape.runout,
                "front_left": shape.front_left,
                "front_right": shape.front_right,
                "height": shape.height,
                "center_of_mass_height": shape.center_of_mass_height,
                "kinetic_energy": ledger.kinetic,
                "potential_energy": ledger.potential,
                "internal_work": ledger.internal_work,
                "elastic_energy": elastic,
                "inelastic_work": ledger.inelastic_work(elastic),
                "wall_work": ledger.wall_work,
                "wall_friction": ledger.wall_friction,
                "numerical_dissipation": ledger.numerical_dissipation,
                "points_asleep": sum(body.count - body.awake for body in self.simulation.bodies),
                "step": self.simulation.steps,
                "wall_time": wall_time,
            }
        )

    def _write_frame(self) -> None:
        simulation, output = self.simulation, self.simulation.scene.output
        if not (output.vtu or output.vtkhdf):
            return
        frame = make_frame(simulation.time, simulation.steps, simulation.bodies, simulation.fields)
        if self.series is not None:
            self.series.write(frame)
        if output.vtkhdf:
            append_frame(self.folder / VTKHDF_NAME, frame)


def prepare_folder(folder: Path, scene_text: str, *, resume: bool, overwrite: bool) -> None:
    """Make a folder ready for a run. Raises InputError where that would lose another run."""
    scene_file = folder / SCENE_NAME
    if resume:
        if not scene_file.is_file():
            raise InputError(f"{folder} holds no run to resume")
        if scene_file.read_text(encoding="utf-8") != scene_text:
            raise InputError(f"{folder} holds a run of another scene than the one to resume")
        return
    if folder.exists() and not folder.is_dir():
        raise InputError(f"output folder {folder} is a file")
    if any(any(folder.glob(pattern)) for pattern in OWN_FILES):
        if not overwrite:
            raise InputError(f"{folder} already holds a run; choose another --out, --resume it or --overwrite it")
        for pattern in OWN_FILES:
            for path in folder.glob(pattern):
                path.unlink()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        atomic.write_text(scene_file, scene_text)
    except OSError as error:
        raise InputError(f"output folder {folder} cannot be written: {error.strerror}") from error


def rewind(folder: Path, simulation: Simulation) -> None:
    """Drop what was written after the checkpoint that the simulation was restored from."""
    drop_rows_after(folder, simulation.steps)
    if simulation.scene.output.vtu:
        FrameSeries(folder).drop_after(simulation.time)
    if simulation.scene.output.vtkhdf:
        _rewind_vtkhdf(folder, simulation)


def _rewind_vtkhdf(folder: Path, simulation: Simulation) -> None:
    """Write run.vtkhdf anew from the VTU frames, or without them cut it: a killed run may have left it damaged."""
    path = folder / VTKHDF_NAME
    if simulation.scene.output.vtu:
        path.unlink(missing_ok=True)
        frames = RunFolder(folder)
        for index in range(len(frames.frame_files)):
            append_frame(path, frames.load_frame(index))
        return
    try:
        drop_after(path, simulation.time)
    except (OSError, KeyError) as error:
        raise InputError(f"{path} was damaged when the run was stopped; --overwrite starts the run again") from error
