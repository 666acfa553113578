"""Memory per point, all included: the greatest resident memory of a process that builds a column and makes steps."""

import json
import resource
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

STEPS = 3


@dataclass(frozen=True)
class Memory:
    """Greatest resident memory [bytes] of a process with so many points; per point, and per point beyond a few."""

    points: int
    resident: int
    bytes_per_point: float
    bytes_per_further_point: float


def memory_per_point(material: str, cell_size: float, small_cell_size: float) -> Memory:
    """Measured in processes of their own; the small column shows what the program takes without points."""
    points, resident = _measured(material, cell_size)
    few, little = _measured(material, small_cell_size)
    return Memory(points, resident, resident / points, (resident - little) / (points - few))


def _measured(material: str, cell_size: float) -> tuple[int, int]:
    command = [sys.executable, "-m", "benchmarks.memory", material, str(cell_size)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=Path(__file__).resolve().parents[1])
    points, resident = json.loads(done.stdout)
    return points, resident


def _measure(material: str, cell_size: float) -> None:
    from benchmarks.columns import make_steps, moving_column

    column = moving_column(material, cell_size)
    make_steps(column, STEPS)
    resident = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(json.dumps([column.bodies[0].count, resident]))


if __name__ == "__main__":
    _measure(sys.argv[1], float(sys.argv[2]))
