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

JUDGED = [measure for measure in MEASURES if measure.symbol in ("w", "H")]


@dataclass(frozen=True)
class Pile:
    """The surface at one time: its height `h` over `x`, the half width, or the radius, and the top, all in m."""

    x: Array
    h: Array
    half_width: float
    top: float


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
