"""What a scene answers, as bands: profile, runout and height; parameters and numerics told apart."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from grainlaw.materials import InputError, SimulationError
from grainlaw.materials.calibration.parameter_file import Calibrated
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.space import Space
from grainlaw.studies.bands import FEWEST_DRAWS, Array, Band, NumericalSpread, band, numerical_spread
from grainlaw.studies.batch import Outcome, run_shown
from grainlaw.studies.draws import Draws, drawn
from grainlaw.studies.ensemble import ESTIMATE, FINER, SHORTER, Plan, drawn_members, numerical_members, plan
from grainlaw.studies.observed import observing
from grainlaw.validation.grains.distance import surface_at
from grainlaw.validation.grains.observation import Observation

RUNS = "runs"
SERIES = ("runout", "height")


@dataclass(frozen=True)
class Prediction:
    """What came out.

    x, times    of the profile [m] and of the series [s]
    profile     height of the surface at the end [m], over x
    series      runout and height [m], over time
    grains      what it is compared with
    width       of the kernel that all are observed with [m]
    space       that all are observed in
    failed      runs that did not finish
    """

    scene: Scene
    plan: Plan
    calibrated: Calibrated
    draws: Draws
    seed: int
    x: Array
    times: Array
    profile: Band
    series: Mapping[str, Band]
    grains: tuple[Observation, ...]
    width: float
    space: Space
    failed: tuple[Outcome, ...]

    @property
    def finished_draws(self) -> int:
        """How many draws the bands are made of."""
        lost = sum(outcome.name.startswith("draw-") for outcome in self.failed)
        return len(self.draws.values) - lost

    @property
    def replaced(self) -> dict[str, tuple[float, float]]:
        """Parameters that were not drawn for which scene and calibration have other values, in this order."""
        given = self.scene.parameters(self.plan.material)._asdict()
        values = self.calibrated.values
        others = values.keys() - {*self.calibrated.table.drawn}
        return {name: (given[name], values[name]) for name in given if name in others and given[name] != values[name]}

    @property
    def is_round(self) -> bool:
        """Whether x is the distance from an axis."""
        return self.space.hoop

    def profile_within(self, grains: Observation) -> float:
        """The share of the profile at the end that lies within the band, where one of them is higher than a grain."""
        surface = surface_at(grains, float(self.times[-1]), self.x)
        there = np.maximum(surface, self.profile.upper) > self.width
        return float(self.profile.holds(surface)[there].mean())


def predict(
    scene: Scene,
    calibrated: Calibrated,
    out: Path,
    *,
    samples: int = 64,
    seed: int = 0,
    grains: Sequence[Path] = (),
    scheduler: str | None = None,
    workers: int | None = None,
    resume: bool = False,
) -> Prediction:
    """Run the draws and what tells the numerical spread below `out`, and make bands of what they show.

    grains     files and folders of grains or experiments to compare with, as for `grainlaw compare --dem`
    the others as for `run_members` and `drawn`

    Raises InputError for fewer samples than a band of 5 to 95 % needs, for a scene without the law or with several
    materials of it, and as `run_members`; SimulationError where too few draws finished, or the estimate did not.
    """
    check_samples(samples)
    prepared, draws = plan(scene, calibrated.law, calibrated.values), drawn(calibrated, samples, seed)
    how = observing(Scene.from_dict(prepared.content, scene.source), grains)
    members = [*numerical_members(prepared), *drawn_members(prepared, draws)]
    outcomes = run_shown(members, out / RUNS, scheduler=scheduler, workers=workers, resume=resume)
    seen = {outcome.name: how.observe(outcome.folder) for outcome in outcomes if not outcome.reason}
    failed = tuple(outcome for outcome in outcomes if outcome.reason)
    _refuse_too_few(seen, failed)
    x = max((one.x for one in seen.values()), key=len)
    times = seen[ESTIMATE].times
    return Prediction(
        scene=scene,
        plan=prepared,
        calibrated=calibrated,
        draws=draws,
        seed=seed,
        x=x,
        times=times,
        profile=band_of({name: surface_at(one, times[-1], x) for name, one in seen.items()}),
        series={
            key: band_of({name: np.interp(times, one.times, one.of(key)) for name, one in seen.items()})
            for key in SERIES
        },
        grains=how.grains,
        width=how.width,
        space=how.space,
        failed=failed,
    )


def check_samples(samples: int) -> None:
    """Raise InputError for fewer draws than a band of 5 to 95 % needs."""
    if samples < FEWEST_DRAWS:
        raise InputError(f"samples = {samples}; a band of 5 to 95 % needs {FEWEST_DRAWS} draws or more")


def band_of(values: Mapping[str, Array]) -> Band:
    """The band of a quantity from its values by the names of the runs."""
    spread: NumericalSpread = numerical_spread(
        values[ESTIMATE],
        values.get(FINER),
        values.get(SHORTER),
        [one for name, one in values.items() if name.startswith("place-")],
    )
    draws = np.array([one for name, one in values.items() if name.startswith("draw-")])
    return band(draws, spread, least=0.0)


def _refuse_too_few(seen: Mapping[str, Observation], failed: Sequence[Outcome]) -> None:
    reasons = {outcome.name: outcome.reason for outcome in failed}
    if ESTIMATE not in seen:
        raise SimulationError(f"the run at the estimate failed: {reasons[ESTIMATE]}")
    left = sum(name.startswith("draw-") for name in seen)
    if left < FEWEST_DRAWS:
        first = next(reason for name, reason in reasons.items() if name.startswith("draw-"))
        raise SimulationError(
            f"{left} draws finished, of which no band of 5 to 95 % can be made; the first failed: {first}"
        )
