"""Memory per point, all included: the greatest resident memory of a process that builds a column and makes steps."""

import json
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


def memory_per_point(material: str, cell_size: float, small_cell_size: float, precision: str) -> Memory:
    """Measured in processes of their own; the small column shows what the program takes without points."""
    points, resident = _measured(material, cell_size, precision)
    few, little = _measured(material, small_cell_size, precision)
    return Memory(points, resident, resident / points, (resident - little) / (points - few))


def _measured(material: str, cell_size: float, precision: str) -> tuple[int, int]:
    command = [sys.executable, "-m", "benchmarks.memory", material, str(cell_size), precision]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=Path(__file__).resolve().parents[1])
    points, resident = json.loads(done.stdout)
    return points, resident


def _measure(material: str, cell_size: float, precision: str) -> None:
    from benchmarks.columns import make_steps, moving_column

    column = moving_column(material, cell_size, precision=precision)
    make_steps(column, STEPS)
    print(json.dumps([column.bodies[0].count, _greatest_resident()]))


def _greatest_resident() -> int:
    """Of this program [bytes]; getrusage would begin with what the process that started it held."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    line = next(line for line in status.splitlines() if line.startswith("VmHWM:"))
    return int(line.split()[1]) * 1024


if __name__ == "__main__":
    _measure(sys.argv[1], float(sys.argv[2]), sys.argv[3])
