"""Writing a run's folder while the run goes on: frames, history rows, checkpoints."""

from pathlib import Path

from grainlaw.mpm_core.output.checkpoint import Clock, write_checkpoint
from grainlaw.mpm_core.output.fields import make_frame
from grainlaw.mpm_core.output.forces import ForcesWriter, force_columns
from grainlaw.mpm_core.output.frame_series import FrameSeries
from grainlaw.mpm_core.output.history import HistoryWriter, read_history
from grainlaw.mpm_core.output.observables import PileShape, interior_overfill, measure_of, pile_shape
from grainlaw.mpm_core.output.obstacle_series import ObstacleSeries
from grainlaw.mpm_core.output.quantities import write_quantities
from grainlaw.mpm_core.output.vtkhdf import VTKHDF_NAME, append_frame
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation

FRAMES_BY_DEFAULT = 30
HISTORY_ROWS_BY_DEFAULT = 300


def frame_interval(scene: Scene) -> float:
    """The time between frames [s]."""
    return scene.output.interval or scene.time.end / FRAMES_BY_DEFAULT


def history_interval(scene: Scene) -> float:
    """The time between rows of the history [s]."""
    return scene.output.history_interval or scene.time.end / HISTORY_ROWS_BY_DEFAULT


class Recorder:
    """The open run folder of one simulation."""

    def __init__(self, folder: Path, simulation: Simulation, clock: Clock) -> None:
        self.folder = folder
        self.simulation = simulation
        self.clock = clock
        self.frame_interval = frame_interval(simulation.scene)
        self.history_interval = history_interval(simulation.scene)
        self.measure = measure_of(simulation.scene)
        self.series = FrameSeries(folder) if simulation.scene.output.vtu else None
        self.history = HistoryWriter(folder)
        frame = make_frame(simulation.time, simulation.steps, simulation.bodies, simulation.fields)
        names = [obstacle.name for obstacle in simulation.obstacles.all]
        self.forces = ForcesWriter(folder, simulation.obstacles, simulation.space) if names else None
        self.obstacles = ObstacleSeries(folder, simulation) if names else None
        write_quantities(folder, frame.fields, simulation.space, force_columns(simulation.space, names))

    def next_frame_time(self) -> float:
        """When the next frame is due [s]: at whole multiples of the interval and at the end."""
        due, end = self.clock.next_frame * self.frame_interval, self.simulation.scene.time.end
        # A multiple that misses the end by rounding is the end.
        return due if due < end * (1.0 - 1e-9) else end

    def shape(self) -> PileShape:
        """The present shape of the material."""
        return pile_shape(self.simulation.bodies, self.measure)

    def record(self, wall_time: float) -> None:
        """Write whatever is due after a step."""
        simulation, clock = self.simulation, self.clock
        clock.wall_time = wall_time
        if simulation.time >= clock.next_history * self.history_interval:
            self._append_history()
            clock.next_history = int(simulation.time / self.history_interval) + 1
            clock.history_rows += 1
        if simulation.time >= self.next_frame_time():
            is_on_interval = simulation.time == clock.next_frame * self.frame_interval
            self._write_frame()
            clock.next_frame += 1
            # An end between two frames is no place to go on from: a longer run would not have stopped there.
            if is_on_interval:
                write_checkpoint(self.folder, simulation, clock)

    def finish(self, wall_time: float) -> None:
        """Write the row of the end, if none was due there."""
        self.clock.wall_time = wall_time
        if read_history(self.folder)["step"][-1] != self.simulation.steps:
            self._append_history()

    def close(self) -> None:
        """Close the tables."""
        self.history.close()
        if self.forces is not None:
            self.forces.close()

    def _append_history(self) -> None:
        if self.forces is not None:
            self.forces.append_row(self.simulation.time)
        shape, ledger, elastic = self.shape(), self.simulation.ledger, self.simulation.elastic_energy()
        overfill = interior_overfill(self.simulation)
        self.history.append(
            {
                "t": self.simulation.time,
                "dt": self.simulation.last_step,
                "runout": shape.runout,
                "front_left": shape.front_left,
                "front_right": shape.front_right,
                "height": shape.height,
                "center_of_mass_height": shape.center_of_mass_height,
                "kinetic_energy": ledger.kinetic,
                "potential_energy": ledger.potential,
                "internal_work": ledger.internal_work,
                "internal_work_on_nodes": ledger.internal_work_on_nodes,
                "elastic_energy": elastic,
                "inelastic_work": ledger.inelastic_work(elastic),
                "wall_work": ledger.wall_work,
                "wall_friction": ledger.wall_friction,
                "obstacle_work": ledger.obstacle_work,
                "obstacle_friction": ledger.obstacle_friction,
                "mass_left": ledger.mass_left,
                "outflow": ledger.outflow,
                "mass_in": ledger.mass_in,
                "inflow": ledger.inflow,
                "numerical_dissipation": ledger.numerical_dissipation,
                "volume_projection": ledger.volume_projection,
                "overfill": overfill.mean,
                "overfill_scatter": overfill.scatter,
                "points_asleep": sum(body.count - body.awake for body in self.simulation.bodies),
                "step": self.simulation.steps,
                "wall_time": self.clock.wall_time,
            }
        )

    def _write_frame(self) -> None:
        simulation, output = self.simulation, self.simulation.scene.output
        if not (output.vtu or output.vtkhdf):
            return
        frame = make_frame(simulation.time, simulation.steps, simulation.bodies, simulation.fields)
        if self.obstacles is not None:
            self.obstacles.write(self.clock.next_frame)
        if self.series is not None:
            self.series.write(frame)
        if output.vtkhdf:
            append_frame(self.folder / VTKHDF_NAME, frame)
