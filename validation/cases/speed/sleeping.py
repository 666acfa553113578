"""The pile of a collapse that sleeps: what it costs from 1.2 s on, and what its profile owes to it."""

import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.cases.collapses.column import collapse
from grainlaw.validation.scenes import advance

Array = NDArray[np.floating[Any]]
START = 1.2
END = {Effort.QUICK: 2.0, Effort.FULL: 3.0}
CELL_SIZE = {Effort.QUICK: 0.025, Effort.FULL: 0.00625}
MATERIALS = {Effort.QUICK: ("MCC OCR 1",), Effort.FULL: ("MCC OCR 1", "MCC OCR 4")}
SPEED = 1e-3
PROFILE_BAND, AWAKE_BAND = 1e-3, {Effort.QUICK: 0.9, Effort.FULL: 0.5}
# Columns of the profile, in cells: narrower ones show single points of the surface.
COLUMN = 4
# The collapse moves as a whole in this time, whose steps count as moving ones.
MOVING = (0.3, 0.4)


class Deposit(NamedTuple):
    """The pile at the end.

    x, depth  places and depths of columns [m]
    awake     mean share of points awake since `START`
    cost      processor time of a step since then over that of a moving step
    """

    x: Array
    depth: Array
    awake: float
    cost: float


def deposit(material: str, effort: Effort, changes: dict[str, Any]) -> Deposit:
    """Lead a collapse to its end."""
    simulation = collapse(material, CELL_SIZE[effort], {"time.end": END[effort], **changes})
    advance(simulation, MOVING[0])
    moving = _cost_of_step(simulation, MOVING[1])
    advance(simulation, START)
    shares: list[float] = []
    (body,) = simulation.bodies
    resting = _cost_of_step(simulation, END[effort], lambda _: shares.append(body.awake / body.count))
    x, depth = _depth(simulation)
    return Deposit(x, depth, float(np.mean(shares)), resting / moving)


def _cost_of_step(simulation: Simulation, end: float, observe: Callable[[Simulation], None] | None = None) -> float:
    """Mean processor time [s] of the steps up to a time [s]."""
    started, steps = time.process_time(), simulation.steps
    advance(simulation, end, observe, intervals=100)
    return (time.process_time() - started) / (simulation.steps - steps)


def _depth(simulation: Simulation) -> tuple[Array, Array]:
    """The volume over columns `COLUMN` cells apart, shared out by hat functions, over their distance."""
    grid, (body,) = simulation.grid, simulation.bodies
    distance = COLUMN * grid.cell_size
    place = (body.positions[0] - grid.lower[0]) / distance
    left = place.astype(int)
    right_share = place - left
    volume = body.volume
    columns = grid.cells[0] // COLUMN + 2
    held = np.bincount(left, volume * (1.0 - right_share), columns)
    held = held + np.bincount(left + 1, volume * right_share, columns)
    return grid.lower[0] + distance * np.arange(columns), held / distance


def compared(material: str, effort: Effort, without: Deposit, asleep: Deposit) -> tuple[Measurement, Measurement]:
    """Area between both profiles over the area of the pile, and the share of points that were awake."""
    area = float(np.abs(asleep.depth - without.depth).sum() / without.depth.sum())
    return (
        upper_bound(f"{material}: area between the profiles over area", "1", area, PROFILE_BAND),
        upper_bound(f"{material}: mean share of points awake", "1", asleep.awake, AWAKE_BAND[effort]),
    )


def measure(effort: Effort) -> Evidence:
    """Cam Clay, with and without sleep."""
    measurements: list[Measurement] = []
    figures, notes = [], []
    for material in MATERIALS[effort]:
        without = deposit(material, effort, {})
        asleep = deposit(material, effort, {"sleep.speed": SPEED, "sleep.start": START})
        measurements += compared(material, effort, without, asleep)
        curves = (
            curve("without sleep", without.x, without.depth, "reference"),
            curve("with sleep", asleep.x, asleep.depth),
        )
        figures.append(Figure(f"Deposit, {material}", "x [m]", "depth [m]", curves))
        notes.append(
            f"{material}: a step from {START:g} s on costs {asleep.cost:.2f} of a moving one with sleep, "
            f"{without.cost:.2f} without (processor time)"
        )
    return Evidence(tuple(measurements), figures=tuple(figures), notes=tuple(notes))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """What slides sleeps too."""
    material, effort = "MCC OCR 4", Effort.QUICK
    too_fast = {"sleep.speed": 0.2, "sleep.start": START}
    without, asleep = (deposit(material, effort, changes) for changes in ({}, too_fast))
    return compared(material, effort, without, asleep)[:1]


CASE = Case(
    name="sleeping",
    title="pile of a collapse that sleeps",
    proves="what rests costs little and is still where it would be",
    reference=f"the same collapse without sleep; sleep.speed = {SPEED:g} m/s",
    norm="area between the profiles of depth over the area of the pile; mean share of points awake",
    mistake="sleep.speed = 0.2 m/s",
    measure=measure,
    control=control,
)
