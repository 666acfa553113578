"""How far a column of grains runs over how slender it is: its runout, power laws, and what was published."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Measurement, upper_bound

# In units of sqrt(H/g). A column needs about 3.3 sqrt(H/g) to come to rest (Lube et al. 2005).
END = 5.0


@dataclass(frozen=True)
class Scaling:
    """(L - L_0)/L_0 = low a for a < tall, high a^exponent above."""

    source: str
    low: float
    high: float
    exponent: float
    tall: float

    def runout(self, aspect_ratio: float) -> float:
        """The published fit."""
        return self.low * aspect_ratio if aspect_ratio < self.tall else self.high * aspect_ratio**self.exponent


@dataclass(frozen=True)
class PowerLaw:
    """prefactor a^exponent through measured values; `error` is the standard error of the exponent, NaN for two."""

    exponent: float
    error: float
    prefactor: float

    def __str__(self) -> str:
        return f"{self.prefactor:.2f} a^({self.exponent:.2f} +- {self.error:.2f})"


def runout_of(simulation: Simulation, width: float, least_depth: float = 0.0) -> float:
    """(L - L_0)/L_0 of half a column of `width` [m], or of a cylinder of this radius, at the axis x = 0.

    L goes up to the first column of cells that holds no point, or material of no more than a depth [m].
    """
    (body,), cell = simulation.bodies, simulation.grid.cell_size
    column = (body.positions[0] / cell).astype(int)
    volumes = np.bincount(column, body.masses / body.initial_density, simulation.grid.cells[0] + 1)
    breadths = cell * (np.arange(len(volumes)) + 0.5) if simulation.space.hoop else 1.0
    covered = volumes > least_depth * cell * breadths
    return float(np.argmin(covered)) * cell / width - 1.0


def outside(label: str, found: float, published: Sequence[float]) -> Measurement:
    """How far a value lies outside the range of published ones, as a share of the nearer end."""
    share = max(0.0, 1.0 - found / min(published), found / max(published) - 1.0)
    return upper_bound(f"{label}: outside the published range", "1", share, 0.0)


def fitted(found: dict[float, float]) -> PowerLaw:
    """The power law through values over aspect ratios, a straight line in logarithmic axes."""
    x, y = np.log(list(found)), np.log(list(found.values()))
    slope, offset = np.polyfit(x, y, 1)
    freedom = len(x) - 2
    residuals = y - slope * x - offset
    error = math.sqrt((residuals**2).sum() / freedom / ((x - x.mean()) ** 2).sum()) if freedom > 0 else math.nan
    return PowerLaw(float(slope), error, math.exp(offset))


def listed(name: str, found: dict[float, float]) -> str:
    """Values over aspect ratios in one line."""
    return f"{name}: " + ", ".join(f"a = {a:g}: {value:.2f}" for a, value in found.items())
