"""Timing on a machine that others use too: what is compared takes turns, and the spread is kept."""

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Spread:
    """Least, median and greatest of several values."""

    least: float
    median: float
    greatest: float


def spread(values: list[float]) -> Spread:
    """The spread of at least one value."""
    return Spread(min(values), statistics.median(values), max(values))


@dataclass(frozen=True)
class Duration:
    """Wall time, and processor time of all threads of this process [s]; other processes add to the first only."""

    wall: float
    cpu: float


def timed(work: Callable[[], object]) -> Duration:
    """How long one call takes."""
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return Duration(time.perf_counter() - wall, time.process_time() - cpu)


def taking_turns(contestants: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, list[Duration]]:
    """Durations of each contestant in rounds, all of them once in each round, so that noise hits them alike."""
    durations: dict[str, list[Duration]] = {name: [] for name in contestants}
    for _ in range(rounds):
        for name, work in contestants.items():
            durations[name].append(timed(work))
    return durations
