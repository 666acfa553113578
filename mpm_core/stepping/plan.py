"""What a scene will use and cost, before it is run."""

import math
import statistics
import time
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from grainlaw.mpm_core.output.checkpoint import Clock
from grainlaw.mpm_core.output.recorder import Recorder, frame_interval, history_interval
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.mpm_core.stepping.compilation import noticed_compilation
from grainlaw.mpm_core.stepping.peak_memory import peak_memory
from grainlaw.mpm_core.stepping.rehearsal import FIRST_STEPS, expected_speed, rehearsals
from grainlaw.mpm_core.stepping.run import built_simulation

TIMED_STEPS = 40


@dataclass(frozen=True)
class Plan:
    """What a run of a scene takes.

    points, points_at_end  with what enters until the end where nothing blocks it
    bytes_per_point    of the arrays that hold the points
    memory_bytes       greatest memory of this process while it built the scene and made the first steps, all included;
                       0 where the system does not tell
    step, critical_time_step  at the start [s]
    steps              with the signal speeds of rehearsals on coarse grids
    wall_time          of all steps and all output [s], without compilation
    compile_time       of the kernels that were not on disk yet and now are [s]
    savings            what this scene need not do or keep
    near_obstacles     pairs of points and obstacles that may touch, after the timed steps; 0 without obstacles
    obstacle_share     of the timed steps that went to obstacles [1]
    """

    laws: list[str]
    points: int
    points_at_end: int
    cells: int
    active_nodes: int
    bytes_per_point: float
    memory_bytes: int
    step: float
    critical_time_step: float
    steps: int
    seconds_per_step: float
    output_time: float
    wall_time: float
    compile_time: float
    frames: int
    fields: list[str]
    savings: list[str]
    threads: int
    near_obstacles: int
    obstacle_share: float


def plan(scene: Scene, threads: int = 1) -> Plan:
    """Build the scene, time some steps, rehearse it on coarse grids. Raises InputError for one that cannot be run."""
    with noticed_compilation() as compilation:
        planned = _plan(scene, threads)
    return replace(planned, compile_time=compilation.seconds)


def _plan(scene: Scene, threads: int) -> Plan:
    started = time.perf_counter()
    simulation = built_simulation(scene, threads)
    build_time = time.perf_counter() - started - simulation.build_time
    stable = simulation.critical_time_step()
    step = scene.time.step or scene.time.safety * stable
    points = simulation.initial_points
    points_at_end = points + simulation.inflows.points_until(scene.time.end)
    stops = math.ceil(scene.time.end / frame_interval(scene) - 1e-9)
    output_time = _output_time(simulation, stops + 1)
    seconds, obstacle_share = _seconds_per_step(simulation)
    memory_bytes = peak_memory()
    played = rehearsals(scene, points_at_end, threads)
    seconds += played[-1].growth * points_at_end
    steps = _steps(scene, expected_speed(played, scene.grid.cell_size), stops)
    return Plan(
        laws=list(dict.fromkeys(body.law.name for body in simulation.bodies)),
        points=points,
        points_at_end=points_at_end,
        cells=math.prod(scene.grid.cells),
        active_nodes=simulation.active.nodes,
        bytes_per_point=_bytes_per_point(simulation),
        memory_bytes=memory_bytes,
        step=step,
        critical_time_step=stable,
        steps=steps,
        seconds_per_step=seconds,
        output_time=output_time,
        wall_time=build_time + steps * seconds + output_time,
        compile_time=0.0,
        frames=stops + 1 if scene.output.vtu or scene.output.vtkhdf else 0,
        fields=simulation.fields,
        savings=_savings(simulation),
        threads=threads,
        near_obstacles=simulation.obstacles.candidates,
        obstacle_share=obstacle_share,
    )


def _bytes_per_point(simulation: Simulation) -> float:
    """Of the body that takes most."""
    return float(max(body.storage.itemsize * len(body.storage) + body.ids.itemsize for body in simulation.bodies))


def _steps(scene: Scene, signal_speed: float, stops: int) -> int:
    """Number of steps; on the way to each of the stops, half a step is lost on average."""
    if scene.time.step is not None:
        return math.ceil(scene.time.end / scene.time.step)
    steps = scene.time.end * signal_speed / (scene.time.safety * scene.grid.cell_size)
    return round(steps + 0.5 * stops)


def _savings(simulation: Simulation) -> list[str]:
    nodes = math.prod(simulation.grid.shape)
    found = [f"grid: {1.0 - simulation.active.nodes / nodes:.0%} of the nodes are not active at the start"]
    if simulation.scene.precision == "single":
        found += [f"single precision: {line}" for line in _in_single(simulation)]
    if "shear_strain" not in simulation.fields:
        found.append("shear strain: not accumulated, as no frame holds it")
    if simulation.scene.sleep.speed is not None:
        found.append(f"sleep: points slower than {simulation.scene.sleep.speed:g} m/s, not counted in the wall time")
    return found


def _in_single(simulation: Simulation) -> list[str]:
    doubles = sorted({body.law.name for body in simulation.bodies if not body.law.holds_in_single})
    laws = [f"{', '.join(doubles)} computed in double, as it does not hold in single"] if doubles else []
    return ["half of the memory for points and for active nodes", *laws]


def _seconds_per_step(simulation: Simulation) -> tuple[float, float]:
    """Median of some steps as a run takes them, after those that compile or load the kernels; the share of obstacles.

    Their contact is counted, not the search for who may touch, which is a part of the sort.
    """
    durations, at_obstacles = [], 0.0
    for number in range(FIRST_STEPS + TIMED_STEPS):
        if number == FIRST_STEPS:
            at_obstacles = simulation.obstacles.wall_time
        dt, _ = simulation.next_step(simulation.time + simulation.scene.time.end)
        started = time.perf_counter()
        simulation.step(dt)
        durations.append(time.perf_counter() - started)
    timed = durations[FIRST_STEPS:]
    return statistics.median(timed), (simulation.obstacles.wall_time - at_obstacles) / sum(timed)


def _output_time(simulation: Simulation, frames: int) -> float:
    """Wall time [s] of all frames with their checkpoints, and of all rows of the history."""
    rows = simulation.scene.time.end / history_interval(simulation.scene)
    with TemporaryDirectory() as folder:
        recorder = Recorder(Path(folder), simulation, Clock())
        durations = [_duration_of_record(recorder) for _ in range(2)]
        recorder.close()
    started = time.perf_counter()
    recorder.shape()
    # The first record imports libraries, as the first one of the run does.
    return durations[0] + frames * durations[1] + rows * (time.perf_counter() - started)


def _duration_of_record(recorder: Recorder) -> float:
    recorder.clock = Clock()
    started = time.perf_counter()
    recorder.record(0.0)
    return time.perf_counter() - started
