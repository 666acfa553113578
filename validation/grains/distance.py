"""How far two observations are apart, and what that means against the scatter of the grains themselves."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from grainlaw.materials import InputError
from grainlaw.validation.grains.coarse_graining import column_weights
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.snapshot import Array


class Verdict(StrEnum):
    """A distance within its band, within twice its band, or beyond."""

    INDISTINGUISHABLE = "indistinguishable"
    ACCEPTABLE = "acceptable"
    DIFFERS = "differs"


def worst(verdicts: Sequence[Verdict]) -> Verdict:
    """The least favourable of several verdicts."""
    return max(verdicts, key=list(Verdict).index)


def verdict(distance: float, band: float) -> Verdict:
    """What a distance means; one that is no number differs."""
    if abs(distance) <= band:
        return Verdict.INDISTINGUISHABLE
    return Verdict.ACCEPTABLE if abs(distance) <= 2.0 * band else Verdict.DIFFERS


def profile_distance(first: Observation, second: Observation, time: float) -> float:
    """E_A: the area between two surfaces over the mean of the areas below them, at a time [s] that both cover.

    Around an axis these are volumes, integrals over r dr.
    """
    x = first.x if len(first.x) >= len(second.x) else second.x
    one, other = surface_at(first, time, x), surface_at(second, time, x)
    weights = column_weights(x, first.space)
    return float((weights * np.abs(one - other)).sum() / (0.5 * (weights * (one + other)).sum()))


def surface_at(observation: Observation, time: float, x: Array) -> Array:
    """The surface at a time and at places [m], linear in between; 0 beyond the lattice."""
    times = observation.times
    after = int(np.clip(np.searchsorted(times, time), 1, len(times) - 1)) if len(times) > 1 else 0
    before = max(after - 1, 0)
    span = times[after] - times[before]
    share = float(np.clip((time - times[before]) / span, 0.0, 1.0)) if span > 0.0 else 1.0
    surface = (1.0 - share) * observation.surface[before] + share * observation.surface[after]
    return np.interp(x, observation.x, surface, left=0.0, right=0.0)


def half_time(observation: Observation) -> float:
    """t50: when half of the growth of the runout is reached [s], linear between the times of the observation."""
    runout = observation.of("runout")
    target = 0.5 * (runout[0] + runout[-1])
    reached = np.flatnonzero(runout >= target)
    if len(reached) == 0 or reached[0] == 0:
        return float("nan")
    after = reached[0]
    share = (target - runout[after - 1]) / (runout[after] - runout[after - 1])
    times = observation.times
    return float(times[after - 1] + share * (times[after] - times[after - 1]))


@dataclass(frozen=True)
class Measure:
    """One number of an observation that is compared relative to the other's; no band: stated, not judged."""

    name: str
    symbol: str
    unit: str
    band: float | None
    of: Callable[[Observation], float]


def _last(name: str) -> Callable[[Observation], float]:
    return lambda observation: float(observation.of(name)[-1]) if name in observation.series else float("nan")


PROFILE_BAND = 0.06
HALF_TIME = "t50"
MEASURES = (
    Measure("runout", "w", "m", 0.06, _last("runout")),
    Measure("height", "H", "m", 0.05, _last("height")),
    Measure("half time", HALF_TIME, "s", 0.05, half_time),
    Measure("interior solid fraction", "phi", "1", None, _last("interior_solid_fraction")),
    Measure("centre of mass", "z_cm", "m", None, _last("center_of_mass_height")),
)


@dataclass(frozen=True)
class Distance:
    """A distance in one measure: E_A, or the difference relative to the reference; `band` None: not judged."""

    name: str
    symbol: str
    unit: str
    measured: float
    reference: float
    distance: float
    band: float | None

    @property
    def verdict(self) -> Verdict | None:
        """What the distance means, if it is judged."""
        return None if self.band is None else verdict(self.distance, self.band)


@dataclass(frozen=True)
class Comparison:
    """An observation against one or several of the same column.

    profiles   E_A at each of `times`, the mean over the references; shape (t,)
    nearest, farthest   the smallest and the largest over the references; shape (t,)
    distances  at rest: E_A first, then the measures
    """

    times: Array
    profiles: Array
    nearest: Array
    farthest: Array
    distances: tuple[Distance, ...]

    @property
    def verdict(self) -> Verdict:
        """The least favourable of the judged distances."""
        return worst([found.verdict for found in self.distances if found.verdict is not None])

    @property
    def deposit(self) -> Verdict:
        """The same for the pile at rest alone, whenever it came to be."""
        verdicts = [found.verdict for found in self.distances if found.symbol != HALF_TIME]
        return worst([found for found in verdicts if found is not None])

    @property
    def decisive(self) -> Distance:
        """The judged distance that uses most of its band."""
        judged = [found for found in self.distances if found.band]
        return max(judged, key=lambda found: np.nan_to_num(abs(found.distance), nan=np.inf) / (found.band or 1.0))


def compare(observation: Observation, references: Sequence[Observation]) -> Comparison:
    """Compare an observation with references of the same column, as if it were one more of them.

    E_A is the mean over the references, each of which has scatter of its own; the measures stand against their mean
    over the references. Raises InputError if the columns are of different size, or one is a cylinder.
    """
    for reference in references:
        refuse_other_size(observation, reference)
    start = max(found.times[0] for found in references)
    end = min(found.times[-1] for found in (observation, *references))
    own = observation.times
    times = np.unique([*own[(own >= start) & (own < end)], end])
    profiles = np.array(
        [[profile_distance(observation, reference, time) for time in times] for reference in references]
    )
    at_rest = float(profiles[:, -1].mean())
    area = Distance("profile at rest", "E_A", "1", at_rest, 0.0, at_rest, PROFILE_BAND)
    return Comparison(
        times=times,
        profiles=profiles.mean(axis=0),
        nearest=profiles.min(axis=0),
        farthest=profiles.max(axis=0),
        distances=(area, *(_relative(measure, observation, references) for measure in MEASURES)),
    )


def _relative(measure: Measure, observation: Observation, references: Sequence[Observation]) -> Distance:
    measured = measure.of(observation)
    reference = float(np.mean([measure.of(found) for found in references]))
    distance = measured / reference - 1.0 if reference else float("nan")
    # What the reference does not tell is not judged.
    band = None if np.isnan(reference) else measure.band
    return Distance(measure.name, measure.symbol, measure.unit, measured, reference, distance, band)


# Columns whose areas at the start differ by more than this factor are not the same case.
SAME_SIZE = 3.0
KIND = {"plane_strain": "a plane column", "axisymmetric": "a cylinder"}


def refuse_other_size(first: Observation, second: Observation) -> None:
    """Raise InputError if the columns at the start differ so much that the units, or the cases, cannot be the same."""
    if first.space is not second.space:
        raise InputError(
            f"{first.label} is {KIND[first.space.name]}, {second.label} {KIND[second.space.name]}: not the same column"
        )
    areas, unit = [found.content(0) for found in (first, second)], "m3" if first.space.hoop else "m2"
    what = "a volume" if first.space.hoop else "an area"
    if not 1.0 / SAME_SIZE < areas[0] / max(areas[1], 1e-300) < SAME_SIZE:
        raise InputError(
            f"{first.label} starts with {what} of {areas[0]:.3g} {unit}, {second.label} with {areas[1]:.3g} {unit}: "
            "not the same column, or not the same units"
        )
