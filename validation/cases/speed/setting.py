"""The settings that are compared, and what one run with them gives."""

import time
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.cases.collapses.column import collapse

END = 1.5
# Before the clock starts: kernels are compiled or loaded.
WARM_UP_STEPS = 2

# Lower left and upper right corner of the column [m]. Settings of `accuracy` were chosen on some of the first five
# (docs/accuracy.md); the case `speed_error` judges each on another one.
COLUMNS: dict[str, tuple[list[float], list[float]]] = {
    "paper": ([1.45, 0.0], [1.75, 0.9]),
    "low": ([1.3, 0.0], [1.9, 0.4]),
    "middle": ([1.4, 0.0], [1.8, 0.6]),
    "square": ([1.35, 0.0], [1.85, 0.5]),
    "tall": ([1.475, 0.0], [1.725, 0.95]),
    "slim": ([1.425, 0.0], [1.775, 0.75]),
    "upright": ([1.375, 0.0], [1.825, 0.65]),
}
# The share of the mass that lies below the height, and between the fronts.
MASS_SHARE = 0.98
OBSERVABLES = ("runout", "height", "center")


@dataclass(frozen=True, order=True)
class Setting:
    """One run: material, column, and what may be chosen for the sake of speed; `cell_size` in m."""

    material: str
    column: str
    cell_size: float
    points_per_cell: int = 16
    safety: float = 0.4
    scheme: str = "affine_flip"
    basis: str = "quadratic"
    precision: str = "double"

    @property
    def key(self) -> str:
        """A name for files."""
        sizes = f"{self.cell_size:.6g}", f"{self.points_per_cell}", f"{self.safety:g}"
        words = (self.material, self.column, *sizes, self.scheme, self.basis, self.precision)
        return "-".join("".join(c for c in word if c.isalnum() or c in "._") for word in words)

    @property
    def changes(self) -> dict[str, Any]:
        """What the shipped scene is changed by."""
        lower, upper = COLUMNS[self.column]
        return {
            "body.0.shape": {"kind": "rectangle", "lower": lower, "upper": upper},
            "body.0.points_per_cell": self.points_per_cell,
            "precision": self.precision,
            "time.safety": self.safety,
            "transfer.scheme": self.scheme,
            "transfer.basis": self.basis,
        }


@dataclass(frozen=True)
class Outcome:
    """What a run led to and cost.

    runout   half of the width between the fronts, beyond each of which lies 1 % of the mass [m]
    height   the level below which lies 98 % of the mass [m]; unlike the summary's it does not depend on the cell
    center   height of the centre of mass [m]
    """

    points: int
    steps: int
    cpu_time: float
    runout: float
    height: float
    center: float
    mark: str

    @property
    def observables(self) -> dict[str, float]:
        """The lengths that errors are counted of."""
        return {name: getattr(self, name) for name in OBSERVABLES}


def measured_outcome(setting: Setting) -> Outcome:
    """Run a collapse on one thread. Raises SimulationError where it breaks down."""
    simulation = collapse(setting.material, setting.cell_size, setting.changes)
    warm_up(simulation, END)
    started = time.process_time()
    simulation.advance_to(END)
    cpu_time = time.process_time() - started
    body = simulation.bodies[0]
    x, y = np.sort(body.positions[0]), np.sort(body.positions[1])
    beyond = round(0.5 * (1.0 - MASS_SHARE) * body.count)
    return Outcome(
        points=body.count,
        steps=simulation.steps,
        cpu_time=cpu_time,
        runout=0.5 * float(x[-1 - beyond] - x[beyond]),
        height=float(y[-1 - 2 * beyond]),
        center=float(y.mean()),
        mark=CORE_MARK,
    )


def warm_up(simulation: Simulation, end: float) -> None:
    """Take the first steps towards a time [s], which load the kernels."""
    for _ in simulation.steps_to(end):
        if simulation.steps >= WARM_UP_STEPS:
            break


def as_dict(setting: Setting, outcome: Outcome) -> dict[str, Any]:
    """Both, for JSON."""
    return {"setting": asdict(setting), "outcome": asdict(outcome)}
