"""A scene on coarse grids, played through before the run: how fast its signals become, and what its points cost.

The number of steps follows from the signal speed over time, which nobody knows beforehand: Cam Clay stiffens under
impact, everything falls. With cells f times as large a run costs 1/f^3, in 3D 1/f^4, and shows most of it. Finer grids
resolve higher peaks of the pressure, so that signals become faster by about the same amount with each halving of the
cell; two coarse grids therefore say what to expect of a fine one. On fewer points than a thousand a column of Cam Clay
may not fall at all, so small scenes are rehearsed as they are.
"""

import math
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, SimulationError
from grainlaw.mpm_core.scene.model import FEWEST_PERIODIC_CELLS, Scene
from grainlaw.mpm_core.simulation import Simulation

# How much coarser, at most; and how many points there have to be.
LARGEST_FACTOR = 4
FEWEST_POINTS = 1000
# Processor time [s] of this thread after which a rehearsal stops where it is.
PATIENCE = 8.0
# The first steps compile or load kernels and sort the points. Then a rehearsal is counted in so many equal parts, each
# of which costs what its median step does: on a busy machine some steps take much longer than the others, and of few
# steps the one or other part would.
FIRST_STEPS, PARTS = 2, 10


@dataclass(frozen=True)
class Rehearsal:
    """What one grid showed.

    travelled holds the way [m] of the fastest signal up to each of the `times` [s]; `growth` is by how much the mean
    time of a step exceeds that of the first steps, per point [s].
    """

    cell_size: float
    times: NDArray[np.float64]
    travelled: NDArray[np.float64]
    growth: float

    def mean_speed(self, until: float) -> float:
        """Mean signal speed [m/s] up to a time [s]."""
        return float(np.interp(until, self.times, self.travelled)) / until


def rehearse(scene: Scene, factor: int, threads: int) -> Rehearsal:
    """Play a scene on cells `factor` times as large until its end, until it breaks down, or until patience ends.

    Raises InputError where the scene cannot be built on such cells.
    """
    simulation = Simulation(_coarsened(scene, factor), threads)
    times, travelled, durations = [0.0], [0.0], []
    started = time.thread_time()
    try:
        signal_speed, before = simulation.signal_speed, time.perf_counter()
        for dt in simulation.steps_to(scene.time.end):
            durations.append(time.perf_counter() - before)
            travelled.append(travelled[-1] + dt * signal_speed)
            times.append(simulation.time)
            if len(durations) == FIRST_STEPS:
                started = time.thread_time()
            if time.thread_time() - started > PATIENCE:
                break
            signal_speed, before = simulation.signal_speed, time.perf_counter()
    except SimulationError:
        pass
    points = max(1, simulation.initial_points + simulation.inflows.points_until(scene.time.end))
    return Rehearsal(simulation.grid.cell_size, np.array(times), np.array(travelled), _growth(durations) / points)


def _growth(durations: list[float]) -> float:
    """By how much the typical step of the whole exceeds that of the first part [s]."""
    medians = [np.median(part) for part in np.array_split(durations[FIRST_STEPS:], PARTS) if len(part) > 0]
    return float(np.mean(medians) - medians[0]) if medians else 0.0


def rehearsals(scene: Scene, points: int, threads: int) -> list[Rehearsal]:
    """The scene on two coarse grids, coarser first; on its own if there is none that divides the domain."""
    found = []
    for factor in _factors(scene, points):
        try:
            found.append(rehearse(scene, factor, threads))
        except InputError:
            continue
    return found or [rehearse(scene, 1, threads)]


def expected_speed(found: list[Rehearsal], cell_size: float) -> float:
    """Mean signal speed [m/s] to expect on cells of a size [m]."""
    first = found[0]
    speed = first.mean_speed(float(first.times[-1]))
    if len(found) == 1:
        return speed
    second = found[1]
    common = float(min(first.times[-1], second.times[-1]))
    levels = math.log(first.cell_size / cell_size) / math.log(first.cell_size / second.cell_size)
    return speed + levels * (second.mean_speed(common) - first.mean_speed(common))


def _factors(scene: Scene, points: int) -> list[int]:
    """The two largest factors that leave whole cells and enough points."""
    cells = scene.grid.cells
    periodic = [
        axis for axis, (side, _) in enumerate(scene.in_space.sides) if scene.boundary.kind_of(side) == "periodic"
    ]
    return [
        factor
        for factor in range(LARGEST_FACTOR, 1, -1)
        if all(count % factor == 0 for count in cells)
        and all(cells[axis] // factor >= FEWEST_PERIODIC_CELLS for axis in periodic)
        and points >= FEWEST_POINTS * factor ** len(cells)
    ][:2]


def _coarsened(scene: Scene, factor: int) -> Scene:
    """The scene on larger cells, with the adaptive step."""
    grid = scene.grid.model_copy(update={"cell_size": factor * scene.grid.cell_size})
    return scene.model_copy(update={"grid": grid, "time": scene.time.model_copy(update={"step": None})})
