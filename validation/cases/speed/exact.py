"""What accuracy costs where the answer is known: the driven square with many settings."""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

from grainlaw.materials import SimulationError
from grainlaw.materials.precision import PRECISIONS
from grainlaw.mpm_core.body import Body
from grainlaw.validation.cases.exact.driven_square import PERIOD, Array, DrivenSquare
from grainlaw.validation.cases.speed.setting import warm_up
from grainlaw.validation.cases.speed.sweep import BASES, SAFETIES, SCHEMES

CELLS = (8, 16, 32)
POINTS_PER_CELL = (4, 16)


@dataclass(frozen=True, order=True)
class ExactSetting:
    """One run of the square."""

    cells: int
    points_per_cell: int
    safety: float
    scheme: str
    basis: str
    precision: str

    @property
    def words(self) -> str:
        """For a line of a report."""
        grid = f"{self.cells} cells, {self.points_per_cell} points per cell"
        return f"{grid}, safety {self.safety:g}, {self.scheme}, {self.basis}, {self.precision}"

    @property
    def tables(self) -> dict[str, dict[str, Any]]:
        """What the scene's tables of the square are changed by."""
        return {
            "time": {"safety": self.safety},
            "transfer": {"scheme": self.scheme, "basis": self.basis},
        }


def exact_settings() -> Iterator[ExactSetting]:
    """All combinations."""
    for values in product(CELLS, POINTS_PER_CELL, SAFETIES, SCHEMES, BASES, PRECISIONS):
        yield ExactSetting(*values)


def cost_and_error(setting: ExactSetting) -> tuple[float, float] | None:
    """Processor time [s] without that of the body force, and error of the place; None for a run that breaks down."""
    square = DrivenSquare(setting.cells, setting.points_per_cell, setting.tables, precision=setting.precision)
    in_force = 0.0

    def timed_force(body: Body, moment: float) -> Array:
        nonlocal in_force
        started = time.process_time()
        found = square.force(body, moment)
        in_force += time.process_time() - started
        return found

    square.simulation.body_force = timed_force
    try:
        warm_up(square.simulation, PERIOD)
        in_force, started = 0.0, time.process_time()
        errors = square.errors_of_a_period()
    except SimulationError:
        return None
    return time.process_time() - started - in_force, errors.displacement
