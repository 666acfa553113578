"""A collapse, run by the library and by the yardstick in turns: the paper's column, or a cylinder."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np

from benchmarks.cylinders import cylinder
from benchmarks.timing import Duration, Spread, spread, timed
from benchmarks.yardstick import Yardstick
from benchmarks.yardstick_3d import Yardstick3D
from grainlaw.materials.precision import PRECISIONS
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.cases.collapses.column import collapse

YARDSTICK = "yardstick"
LAPS = 60


@dataclass(frozen=True)
class Course:
    """What is run: the simulation of a material on cells of a size [m], with changes by dotted key; the yardstick."""

    simulation: Callable[[str, float, dict[str, Any]], Simulation]
    yardstick: type[Yardstick]


PLANE, THREE_D = Course(collapse, Yardstick), Course(cylinder, Yardstick3D)


@dataclass
class Contestant:
    """A program that can be led to a time, and how long it took for each lap."""

    name: str
    program: Simulation | Yardstick
    advance_to: Callable[[float], None]
    durations: list[Duration] = field(default_factory=list)
    steps: list[int] = field(default_factory=list)

    def run_lap(self, end: float) -> None:
        """Go on to a time [s]."""
        before = self.program.steps
        self.durations.append(timed(lambda: self.advance_to(end)))
        self.steps.append(self.program.steps - before)


@dataclass(frozen=True)
class Result:
    """One contestant: point-steps/s over the whole run, by wall time and by processor time, and lap by lap.

    `ratio` is that of point-steps/s to the yardstick's in the same lap; None for the yardstick.
    """

    name: str
    steps: int
    wall_time: float
    rate: float
    cpu_rate: float
    rates: Spread
    ratio: Spread | None
    cpu_ratio: float | None


def race(
    material: str, cell_size: float, end: float, threads: Sequence[int] = (1, 2), course: Course = PLANE
) -> list[Result]:
    """Lead all contestants to `end` [s] in laps: first a short one, not counted, that compiles.

    The library runs in both precisions, the yardstick in double.
    """
    kinds = product(PRECISIONS, threads)
    contestants = [_library(course, material, cell_size, precision, count) for precision, count in kinds]
    points = contestants[0].program.bodies[0].count  # type: ignore[union-attr]
    contestants.append(_yardstick(course, material, cell_size))
    for one in contestants:
        one.advance_to(end / 1e3)
    for lap_end in np.linspace(end / 1e3, end, LAPS + 1)[1:]:
        for one in contestants:
            one.run_lap(float(lap_end))
    return [_result(one, contestants[-1], points) for one in contestants]


def _library(course: Course, material: str, cell_size: float, precision: str, threads: int) -> Contestant:
    simulation = course.simulation(material, cell_size, {"precision": precision})
    simulation.threads = threads
    name = f"library, {precision}, {threads} thread(s)"
    return Contestant(name, simulation, simulation.advance_to)


def _yardstick(course: Course, material: str, cell_size: float) -> Contestant:
    yardstick = course.yardstick(course.simulation(material, cell_size, {}))
    return Contestant(YARDSTICK, yardstick, yardstick.advance_to)


def _rates(one: Contestant, points: int) -> list[float]:
    return [points * count / taken.wall for count, taken in zip(one.steps, one.durations, strict=True)]


def _result(one: Contestant, yardstick: Contestant, points: int) -> Result:
    rates, reference = _rates(one, points), _rates(yardstick, points)
    wall, cpu = (sum(getattr(taken, kind) for taken in one.durations) for kind in ("wall", "cpu"))
    cpu_reference = points * sum(yardstick.steps) / sum(taken.cpu for taken in yardstick.durations)
    is_reference = one is yardstick
    return Result(
        name=one.name,
        steps=sum(one.steps),
        wall_time=wall,
        rate=points * sum(one.steps) / wall,
        cpu_rate=points * sum(one.steps) / cpu,
        rates=spread(rates),
        ratio=None if is_reference else spread([a / b for a, b in zip(rates, reference, strict=True)]),
        cpu_ratio=None if is_reference else points * sum(one.steps) / cpu / cpu_reference,
    )
