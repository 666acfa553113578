"""A deep slot between rough walls, whose floor sinks slowly: the walls carry what Janssen's theory says."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.scenes import advance, shipped_simulation

Floats = NDArray[np.float64]

BAND = 0.05
GRAVITY, DENSITY, WIDTH, FRICTION = 9.81, 1500.0, 0.2, 0.3
CELLS = {Effort.QUICK: (0.0125,), Effort.FULL: (0.0125, 0.00625)}
# While the walls hold what they can; stresses are means over looks, in slices of the fill.
FROM, UNTIL, LOOKS, SLICE = 0.6, 1.2, 30, 0.05
# Slices at the free surface and at the floor say nothing of the walls.
ENDS = 2


@dataclass(frozen=True)
class Silo:
    """What a silo in its steady state shows, per width.

    floor      share of the weight that the floor carries
    mobilised  friction of the walls over the force on them, over its coefficient
    levels     of the slices over the floor [m]
    vertical   mean stress of each slice [Pa]
    sideways   stress at the walls of each slice [Pa]
    depth      of the fill, if it were as dense as at the start [m]
    """

    floor: float
    mobilised: float
    levels: Floats
    vertical: Floats
    sideways: Floats
    depth: float

    @property
    def stress_ratio(self) -> float:
        """Stress on the walls over the mean vertical one."""
        inner = slice(ENDS, -ENDS)
        return float(self.sideways[inner].sum() / self.vertical[inner].sum())

    @property
    def janssen(self) -> float:
        """The share of the weight that reaches the floor, with the stress ratio that the run has."""
        length = WIDTH / (2.0 * FRICTION * self.stress_ratio)
        return length / self.depth * (1.0 - math.exp(-self.depth / length))


def silo(cell: float, friction: float = FRICTION) -> Silo:
    """Run the shipped scene with cells of a size [m]."""
    changes = {"grid.cell_size": cell} | {f"obstacle.{wall}.friction": friction for wall in (1, 2)}
    simulation = shipped_simulation("silo_walls", changes)
    floor, left, right = simulation.obstacles.all
    (body,) = simulation.bodies
    start = float(body.positions[1].min())
    advance(simulation, FROM)
    for obstacle in simulation.obstacles.all:
        obstacle.forces.reset()
    sums: Floats = np.zeros((2, round(1.0 / SLICE)))

    def look(present: Simulation) -> None:
        nonlocal sums
        sunk = present.time * float(floor.motion.pose.velocity[1])
        slices = np.clip(((body.positions[1] - start - sunk) / SLICE).astype(int), 0, sums.shape[1] - 1)
        at_wall = np.minimum(body.positions[0], WIDTH - body.positions[0]) < cell
        sums += [
            _means(-body.stress[1], slices, sums.shape[1]),
            _means(-body.stress[0], slices, sums.shape[1], at_wall),
        ]

    advance(simulation, UNTIL, look, LOOKS)
    weight = float(body.masses.sum()) * GRAVITY
    forces = {obstacle.name: obstacle.forces.means()[0] for obstacle in (floor, left, right)}
    pushed = 0.5 * (forces["right_wall"][0] - forces["left_wall"][0])
    carried = -0.5 * (forces["left_wall"][1] + forces["right_wall"][1])
    levels: Floats = np.asarray(SLICE * (np.arange(sums.shape[1]) + 0.5), np.float64)
    sums /= LOOKS
    share, depth = -float(forces["floor"][1]) / weight, weight / (GRAVITY * DENSITY * WIDTH)
    return Silo(share, float(carried / pushed / FRICTION), levels, sums[0], sums[1], depth)


def _means(values: Floats, slices: NDArray[np.int64], count: int, which: NDArray[np.bool_] | None = None) -> Floats:
    """Means of the points' values in slices."""
    chosen = np.ones(len(slices), bool) if which is None else which
    sums = np.bincount(slices[chosen], values[chosen], count)
    return np.asarray(sums / np.maximum(np.bincount(slices[chosen], minlength=count), 1))


def measure(effort: Effort) -> Evidence:
    """The shipped scene; in full also on half of its cells."""
    found, curves, notes = [], [], []
    for cell in CELLS[effort]:
        run, label = silo(cell), f"{1e3 * cell:g} mm"
        found.append(relative_error(f"weight on the floor, {label}", "1", run.floor, run.janssen, BAND))
        found.append(relative_error(f"friction of the walls, {label}", "1", run.mobilised, 1.0, BAND))
        curves.append(curve(f"vertical stress, {label}", run.levels, run.vertical))
        notes.append(f"{label}: stress ratio {run.stress_ratio:.3f}")
    figure = Figure("Stress in a silo", "level over the floor [m]", "stress [Pa]", tuple(curves))
    return Evidence(tuple(found), figures=(figure,), notes=tuple(notes))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Walls with 20 % less friction, taken for what they are not."""
    run = silo(CELLS[Effort.QUICK][0], 0.8 * FRICTION)
    return (relative_error("weight on the floor", "1", run.floor, run.janssen, BAND),)


CASE = Case(
    name="janssen",
    title="weight on the floor of a deep slot of sand between rough walls",
    proves="friction at resting obstacles carries what it must when the material slides along them",
    reference="sigma = rho g l (1 - exp(-z/l)), l = W/(2 mu K) (Janssen 1895), with the stress ratio K of the run",
    norm="relative error of the share of the weight that the floor carries, and of the friction of the walls",
    mistake="friction of the walls 20 % smaller than the theory is given",
    measure=measure,
    control=control,
)
