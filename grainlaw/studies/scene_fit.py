"""Calibration on whole scenes: parameters of a law from profiles of grains, by running the scene.

Measured are heights of the surface at the end (`profiles`).

A run answers with a noise of its own: points that lie elsewhere within their cells give another pile. It is measured at
the start from four such places, and differences are taken over steps in which the answer changes by several times as
much: a step that does not is doubled, up to what an interval may reach for its parameter to count as determined. The
scatter about the law, which stands in for standard errors, holds this noise too.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from grainlaw.materials import InputError, Law, SimulationError
from grainlaw.materials.calibration.coordinates import (
    Array,
    Coordinate,
    bounds_of,
    coordinate,
    coordinates_of,
    off_bounds,
    values_at,
)
from grainlaw.materials.calibration.findings import reach_of
from grainlaw.materials.calibration.fit import Fit, check_names
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.studies.cluster import workers_of
from grainlaw.studies.draws import allows
from grainlaw.studies.ensemble import ESTIMATE, material_of, numerical_changes, plan
from grainlaw.studies.observed import observing
from grainlaw.studies.profiles import Asked, ProfileModel, places_of

# In the coordinates of a fit: of a logarithm, or of a parameter over its start.
FIRST_STEP = 0.1
# Change of the answer over a step, in the noise of a difference.
CLEAR = 5.0
# Of the sum of squares: with 20 measurements a fifth of a standard deviation; and of the coordinates.
TOLERANCE, SMALLEST_MOVE = 3e-3, 1e-3
MOST_RUNS = 12


@dataclass(frozen=True)
class SceneFit(Fit):
    """A fit to profiles.

    model   what was run and compared
    noise   of the answer of a run, over the size of the profile [1]
    steps   over which differences were taken, shape (parameters,)
    """

    model: ProfileModel
    noise: float
    steps: Array


@dataclass
class _Search:
    """The functions that least squares asks for, and what they remember."""

    model: ProfileModel
    chosen: tuple[Coordinate, ...]
    start: Mapping[str, float]
    steps: Array
    noise: float = 0.0
    known: dict[bytes, Array] = field(default_factory=dict)

    def values(self, point: Array) -> dict[str, float]:
        return values_at(self.chosen, point, self.start)

    def residuals(self, point: Array) -> Array:
        """Where the law refuses a point, or its run fails, no numbers: least squares then tries a shorter step."""
        if not self._is_allowed(point):
            return np.full(self.model.size, np.nan)
        if point.tobytes() not in self.known:
            name = f"search-{len(self.known):02}"
            self.known[point.tobytes()] = self.model.residuals({name: (self.values(point), {})})[name]
        return self.known[point.tobytes()]

    def begin(self, point: Array) -> None:
        """Run the start, and the same at other places of its points within their cells, which tell the noise."""
        changes = numerical_changes(self.model.scene.model_dump(mode="json", exclude_none=True))
        asked: Asked = {
            f"start-{name}": (self.values(point), change)
            for name, change in changes.items()
            if name == ESTIMATE or name.startswith("place")
        }
        found = self.model.residuals(asked)
        start = found.pop(f"start-{ESTIMATE}")
        if not np.isfinite(start).all():
            raise SimulationError("the scene fails with the parameters from which the search begins")
        self.known[point.tobytes()] = start
        others = np.array([one for one in found.values() if np.isfinite(one).all()])
        if len(others) > 1:
            self.noise = float(np.sqrt(np.var(others, axis=0, ddof=1).mean()))

    def jacobian(self, point: Array) -> Array:
        """Central differences, one-sided where the law refuses the other side or its run fails."""
        around = len(self.known)
        columns = self._differences(point, range(len(self.chosen)), f"step-{around:02}")
        return np.array([columns[index] for index in range(len(self.chosen))]).T

    def lengthen(self, point: Array) -> None:
        """Double the steps over which the answer does not change clearly."""
        unclear = list(range(len(self.chosen)))
        for attempt in range(10):
            found = self._differences(point, unclear, f"first-{attempt}")
            least = CLEAR * self.noise * math.sqrt(2.0 * self.model.size)
            unclear = [
                index
                for index, column in found.items()
                if np.linalg.norm(2.0 * self.steps[index] * column) < least
                and 2.0 * self.steps[index] <= reach_of(self.chosen[index], float(point[index]))
            ]
            if not unclear:
                return
            self.steps[unclear] *= 2.0

    def _differences(self, point: Array, which: Sequence[int], label: str) -> dict[int, Array]:
        lower, upper = bounds_of(self.chosen)
        moved: dict[tuple[int, int], Array] = {}
        for index in which:
            for sign in (-1, 1):
                other = point.copy()
                other[index] = np.clip(point[index] + sign * self.steps[index], lower[index], upper[index])
                if other[index] != point[index] and self._is_allowed(other):
                    moved[index, sign] = other
        names = {key: f"{label}-{self.chosen[key[0]].name}-{'up' if key[1] > 0 else 'down'}" for key in moved}
        found = self.model.residuals({names[key]: (self.values(other), {}) for key, other in moved.items()})
        columns = {}
        for index in which:
            sides = [(moved[key][index], found[names[key]]) for key in moved if key[0] == index]
            sides = [(u, one) for u, one in sides if np.isfinite(one).all()]
            if len(sides) == 1:
                sides.append((point[index], self.residuals(point)))
            if not sides:
                at = f"{self.chosen[index].name} = {self.chosen[index].value(float(point[index])):g}"
                raise SimulationError(f"the fit runs to {at}, beside which the scene cannot be run; fix it")
            (first, below), (second, above) = sides
            columns[index] = (above - below) / (second - first)
        return columns

    def _is_allowed(self, point: Array) -> bool:
        return allows(self.model.law, self.values(point))


def fit_scene(
    law: Law,
    scene: Scene,
    grains: Sequence[Path],
    fitted: Sequence[str],
    out: Path,
    *,
    start: Mapping[str, float] | None = None,
    fixed: Mapping[str, float] | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    resume: bool = False,
) -> SceneFit:
    """Fit parameters of a law to the profiles of grains by running a scene with it.

    grains   files and folders of grains or experiments, as for `grainlaw compare --dem`; all of the same scene
    fitted   names of the parameters; each takes two runs for every step of the search
    start    values by name that replace those of the scene; `fixed` stay as they are besides
    the others as for `run_members`

    Raises InputError for an unknown name, a scene without the law, grains of another column or too few of them, and as
    `run_members`; SimulationError where the scene cannot be run at the start or beside a point of the search.
    """
    check_names(law, fitted, tuple(fixed or ()))
    if not fitted:
        raise InputError("--scene needs --fit PARAMETER: each parameter takes two runs for every step of the search")
    if not grains:
        raise InputError("--scene needs --dem FILE: the grains, or the experiment, to whose profile it is fitted")
    given = scene.parameters(material_of(scene, law))._asdict()
    begin = law.checked({**given, **(start or {}), **(fixed or {})}, law.name)._asdict()
    how = observing(Scene.from_dict(plan(scene, law, begin).content, scene.source), grains)
    places = tuple(places_of(one, how.width, scene.time.end) for one in how.grains)
    chosen = tuple(coordinate(name, law.parameter_declarations[name], begin[name]) for name in fitted)
    size = sum(len(one.x) for one in places)
    if size <= len(chosen):
        raise InputError(f"{size} places of the profile cannot determine {len(chosen)} parameters")
    # The same processes for all rounds.
    with workers_of(scheduler, workers) as client:
        address = str(client.scheduler_info()["address"])
        model = ProfileModel(scene, law, out, how, places, address, resume)
        return _solved(model, chosen, begin)


def _solved(model: ProfileModel, chosen: tuple[Coordinate, ...], begin: Mapping[str, float]) -> SceneFit:
    bounds = bounds_of(chosen)
    search = _Search(model, chosen, begin, np.full(len(chosen), FIRST_STEP))
    point = off_bounds(coordinates_of(chosen, begin), bounds, SMALLEST_MOVE)
    search.begin(point)
    search.lengthen(point)
    options: dict[str, Any] = {"x_scale": "jac", "ftol": TOLERANCE, "xtol": SMALLEST_MOVE, "max_nfev": MOST_RUNS}
    found = least_squares(search.residuals, point, jac=search.jacobian, bounds=bounds, **options)
    return SceneFit(
        law=model.law,
        sources=tuple(places.grains.label for places in model.places),
        knows_errors=False,
        coordinates=chosen,
        solution=found.x,
        start=dict(begin),
        values=search.values(found.x),
        residuals=found.fun,
        jacobian=found.jac,
        without_effect=(),
        left_out=(),
        converged=found.status > 0,
        model=model,
        noise=search.noise,
        steps=search.steps,
    )
