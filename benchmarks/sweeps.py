"""What a second worker gains in a sweep: the same runs with one process and with two, all start-up included."""

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from grainlaw.studies.sweep import sweep


@dataclass(frozen=True)
class SweepTimes:
    """Wall time [s] of a sweep with one worker and with two, and the second over the first."""

    runs: int
    one: float
    two: float
    ratio: float


def gain_of_a_second_worker(scene: str, cell_size: float, end: float, values: int) -> SweepTimes:
    """Sweep the paper's column over the friction of the floor and its density, with so many values of each.

    A short sweep goes before, so that kernels are on disk.
    """
    _sweep_time(scene, cell_size, end, 2, 1)
    one, two = (_sweep_time(scene, cell_size, end, values, workers) for workers in (1, 2))
    return SweepTimes(values**2, one, two, two / one)


def _sweep_time(scene: str, cell_size: float, end: float, values: int, workers: int) -> float:
    vary = {"boundary.bottom.coefficient": f"0.3:0.7:{values}", "body.0.density": f"1400.0:1500.0:{values}"}
    changes = {"grid.cell_size": cell_size, "time.end": end, "output.pictures": False}
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        found = sweep(scene, Path(folder), vary, changes=changes, workers=workers)
        spent = time.perf_counter() - started
    if found.failed:
        raise RuntimeError(f"{len(found.failed)} runs failed, for instance: {found.failed[0].reason}")
    return spent
