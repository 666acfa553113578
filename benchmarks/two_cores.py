"""What a second thread gains, beside what a second core has to give: two runs of one thread each, at once.

Cores that share their power, their memory or themselves with others do less than twice the work, whatever the program.
"""

import multiprocessing
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection

from benchmarks.columns import make_steps, moving_column
from benchmarks.sizes import steps_of_a_turn
from benchmarks.timing import Spread, spread, timed


@dataclass(frozen=True)
class TwoCores:
    """Work per time on two cores over that on one, round by round, for a column of so many points.

    threads  one run of two threads
    runs     two runs of one thread each, at once
    share    the first over the second
    """

    points: int
    threads: Spread
    runs: Spread
    share: Spread


def gain_of_two_cores(material: str, cell_size: float, rounds: int, precision: str) -> TwoCores:
    """Measure in rounds of three turns: one run alone, the same with two threads, and two runs at once."""
    column = material, cell_size, precision
    with _run(*column) as first, _run(*column) as second:
        points, _ = first.recv(), second.recv()
        steps = steps_of_a_turn(points)
        threads, runs = [], []
        for _ in range(rounds):
            (alone,) = _times(steps, 1, first)
            (shared,) = _times(steps, 2, first)
            beside = _times(steps, 1, first, second)
            threads.append(alone / shared)
            runs.append(sum(alone / each for each in beside))
    shares = [one / two for one, two in zip(threads, runs, strict=True)]
    return TwoCores(points, spread(threads), spread(runs), spread(shares))


@contextmanager
def _run(material: str, cell_size: float, precision: str) -> Iterator[Connection]:
    """A process that makes steps of a column when told to."""
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_serve, args=(there, material, cell_size, precision))
    process.start()
    try:
        yield here
    finally:
        here.send(None)
        process.join()


def _serve(connection: Connection, material: str, cell_size: float, precision: str) -> None:
    column = moving_column(material, cell_size, precision=precision)
    make_steps(column, 3)
    connection.send(column.bodies[0].count)
    while (order := connection.recv()) is not None:
        steps, threads = order
        column.threads = threads
        make_steps(column, 1)
        connection.send(timed(partial(make_steps, column, steps)).wall)


def _times(steps: int, threads: int, *runs: Connection) -> list[float]:
    """Wall time [s] that each of some runs takes for its steps, all at once."""
    for run in runs:
        run.send((steps, threads))
    return [float(run.recv()) for run in runs]
