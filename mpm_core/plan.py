"""What a scene will use and cost, before it is run."""

import math
import time
from dataclasses import dataclass

from mpm_core.grid import COMPONENTS
from mpm_core.recorder import FRAMES_BY_DEFAULT
from mpm_core.run import built_simulation
from mpm_core.scene import Scene
from mpm_core.simulation import Simulation

REHEARSAL_STEPS = 40


@dataclass(frozen=True)
class Plan:
    """What a run of a scene takes.

    steps and wall_time hold if the material keeps the sound speed of the start; a law that stiffens under impact takes
    more steps.
    """

    laws: list[str]
    points: int
    cells: int
    nodes_in_reach: int
    bytes_per_point: float
    memory_bytes: int
    step: float
    stable_step: float
    steps: int
    seconds_per_step: float
    wall_time: float
    frames: int
    fields: list[str]
    threads: int


def plan(scene: Scene, threads: int = 1) -> Plan:
    """Build the scene, rehearse a few steps and extrapolate. Raises InputError for a scene that cannot be run."""
    simulation = built_simulation(scene, threads)
    stable = simulation.stable_step()
    step = scene.time.step or scene.time.safety * stable
    points = sum(body.count for body in simulation.bodies)
    point_bytes = sum(body.points.nbytes + body.ids.nbytes for body in simulation.bodies)
    window = simulation.window
    nodes = (window.last_x - window.first_x + 1) * (window.last_y - window.first_y + 1)
    seconds = _seconds_per_step(simulation, min(step, stable))
    steps = int(scene.time.end / step) + 1
    interval = scene.output.interval or scene.time.end / FRAMES_BY_DEFAULT
    return Plan(
        laws=list(dict.fromkeys(body.law.name for body in simulation.bodies)),
        points=points,
        cells=scene.grid.cells[0] * scene.grid.cells[1],
        nodes_in_reach=nodes,
        bytes_per_point=point_bytes / points,
        memory_bytes=point_bytes + 8 * COMPONENTS * nodes,
        step=step,
        stable_step=stable,
        steps=steps,
        seconds_per_step=seconds,
        wall_time=steps * seconds,
        frames=math.ceil(scene.time.end / interval - 1e-9) + 1 if scene.output.vtu or scene.output.vtkhdf else 0,
        fields=simulation.fields,
        threads=threads,
    )


def _seconds_per_step(simulation: Simulation, dt: float) -> float:
    # The first steps compile or load the kernels and sort the points.
    for _ in range(2):
        simulation.step(dt)
    started = time.perf_counter()
    for _ in range(REHEARSAL_STEPS):
        simulation.step(dt)
    return (time.perf_counter() - started) / REHEARSAL_STEPS
