"""How far the pile of another code is from ours at one time: E_A, half width and top, in the bands of the grains."""

from dataclasses import dataclass

import numpy as np

from grainlaw.validation.grains.distance import (
    MEASURES,
    PROFILE_BAND,
    Distance,
    Verdict,
    profile_distance,
    refuse_other_size,
    surface_at,
    worst,
)
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.snapshot import Array
from grainlaw.validation.grains.surface import fronts

# At which shapes are compared.
PLACES = 2001
JUDGED = [measure for measure in MEASURES if measure.symbol in ("w", "H")]


@dataclass(frozen=True)
class Pile:
    """The surface at one time: its height `h` over `x`, the half width, or the radius, and the top, all in m."""

    x: Array
    h: Array
    half_width: float
    top: float

    @property
    def area(self) -> float:
        """Below the surface [m2]."""
        return float(np.trapezoid(self.h, self.x))

    def of_unit_area(self, x: Array) -> Array:
        """The height at places `x` of the same shape with an area of 1 below it."""
        size = np.sqrt(self.area)
        return np.interp(x * size, self.x, self.h, left=0.0, right=0.0) / size


@dataclass(frozen=True)
class PileDistance:
    """A run beside another code at a time [s]: both piles, and E_A, w and H."""

    run: str
    code: str
    time: float
    ours: Pile
    theirs: Pile
    distances: tuple[Distance, ...]

    @property
    def verdict(self) -> Verdict:
        """The least favourable of the three."""
        return worst([found.verdict for found in self.distances if found.verdict is not None])

    @property
    def shape_distance(self) -> float:
        """E_A of the two in plane strain, each drawn to the same area: what is left if one has lost, or swollen."""
        reach = max(pile.x.max() / np.sqrt(pile.area) for pile in (self.ours, self.theirs))
        x = np.linspace(-reach, reach, PLACES)
        return float(np.trapezoid(np.abs(self.ours.of_unit_area(x) - self.theirs.of_unit_area(x)), x))

    @property
    def decisive(self) -> Distance:
        """The one that uses most of its band."""
        return max(
            self.distances, key=lambda found: np.nan_to_num(abs(found.distance), nan=np.inf) / (found.band or 1.0)
        )


def pile_at(observation: Observation, time: float, width: float) -> Pile:
    """The pile at a time [s]; its half width, or radius, is where it is as high as `width` [m]."""
    surface = surface_at(observation, time, observation.x)
    left, right = fronts(observation.x, surface, width)
    half_width = right if observation.space.hoop else 0.5 * (right - left)
    return Pile(observation.x, surface, half_width, float(surface.max()))


def compare_piles(run: Observation, code: Observation, width: float) -> PileDistance:
    """The two at the last time that both reach. Raises InputError for columns of different size, or one a cylinder."""
    refuse_other_size(run, code)
    time = min(float(run.times[-1]), float(code.times[-1]))
    ours, theirs = pile_at(run, time, width), pile_at(code, time, width)
    area = profile_distance(run, code, time)
    pairs = ((ours.half_width, theirs.half_width), (ours.top, theirs.top))
    distances = [Distance("profile", "E_A", "1", area, 0.0, area, PROFILE_BAND)]
    for measure, (measured, reference) in zip(JUDGED, pairs, strict=True):
        relative = measured / reference - 1.0 if reference else float("nan")
        distances.append(
            Distance(measure.name, measure.symbol, measure.unit, measured, reference, relative, measure.band)
        )
    return PileDistance(run.label, code.label, time, ours, theirs, tuple(distances))
