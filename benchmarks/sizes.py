"""Cost of a point-step over the number of points and threads, and over the size of an empty domain."""

from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.columns import make_steps, moving_column
from benchmarks.timing import Duration, Spread, spread, taking_turns
from grainlaw.mpm_core.simulation import Simulation

# Enough for the points to be sorted at least once; so few that the column keeps its shape.
FEWEST_STEPS, MOST_STEPS = 40, 200
POINT_STEPS_PER_TURN = 4e6


@dataclass(frozen=True)
class Cost:
    """Time per point-step [ns] of a column on some threads, and the number of its points.

    `gain` is the wall time of one thread over that of these in the same round; None for one thread.
    """

    points: int
    threads: int
    nanoseconds: Spread
    cpu_nanoseconds: Spread
    gain: Spread | None


def steps_of_a_turn(points: int) -> int:
    """How many steps a column of so many points makes in its turn."""
    return min(max(FEWEST_STEPS, round(POINT_STEPS_PER_TURN / points)), MOST_STEPS)


def cost_over_size(
    material: str, cell_sizes: Sequence[float], threads: Sequence[int], rounds: int, precision: str
) -> list[Cost]:
    """Columns of several cell sizes, all in each round."""
    columns = {cell_size: moving_column(material, cell_size, precision=precision) for cell_size in cell_sizes}
    for column in columns.values():
        make_steps(column, 3)
    turns = {(size, count): _Turn(column, count) for size, column in columns.items() for count in threads}
    durations = taking_turns({str(key): turn for key, turn in turns.items()}, rounds)
    return [
        _cost(turn, durations[str((size, count))], durations.get(str((size, 1)), []) if count > 1 else [])
        for (size, count), turn in turns.items()
    ]


def cost_over_domain(
    material: str, cell_size: float, times: Sequence[int], rounds: int, precision: str
) -> list[tuple[int, Cost]]:
    """The same column in the paper's domain, and in ones so many times larger along both axes; (cells, cost)."""
    found = []
    columns = {factor: moving_column(material, cell_size, 1, factor, precision) for factor in times}
    for column in columns.values():
        make_steps(column, 3)
    turns = {factor: _Turn(column, 1) for factor, column in columns.items()}
    durations = taking_turns({str(factor): turn for factor, turn in turns.items()}, rounds)
    for factor, turn in turns.items():
        cells = turn.column.scene.grid.cells
        found.append((cells[0] * cells[1], _cost(turn, durations[str(factor)], [])))
    return found


class _Turn:
    """Some steps of a column on a number of threads."""

    def __init__(self, column: Simulation, threads: int) -> None:
        self.column = column
        self.threads = threads
        self.points = column.bodies[0].count
        self.steps = steps_of_a_turn(self.points)

    def __call__(self) -> None:
        self.column.threads = self.threads
        make_steps(self.column, self.steps)


def _cost(turn: _Turn, durations: list[Duration], alone: list[Duration]) -> Cost:
    """The cost of a turn; `alone` are the durations of one thread in the same rounds, where they are to be compared."""
    per_point_step = 1e9 / (turn.points * turn.steps)
    return Cost(
        points=turn.points,
        threads=turn.threads,
        nanoseconds=spread([taken.wall * per_point_step for taken in durations]),
        cpu_nanoseconds=spread([taken.cpu * per_point_step for taken in durations]),
        gain=spread([one.wall / taken.wall for one, taken in zip(alone, durations, strict=True)]) if alone else None,
    )
