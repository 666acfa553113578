"""The paper's column with one value over a range that a user may set, a row for each value.

Each row claims two things: every run survives, and the piles are related as the physics of that value asks. The
negative control makes a mistake that the second claim must notice.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from grainlaw.validation.case import Case, Effort, Evidence, Measurement, relative_error, upper_bound
from grainlaw.validation.cases.collapses.column import CELL_SIZE, collapse, published_viscous
from grainlaw.validation.cases.hard.survival import NORM, SURVIVAL, Trial, notes, survivals, trial

END = {Effort.QUICK: 0.6, Effort.FULL: 1.5}
BAND = 5e-2
START_HEIGHT = 0.9
Trials = Mapping[float, Trial]


@dataclass(frozen=True)
class Range:
    """A row of the table.

    label     of a value, in the format of `str.format`
    changes   of the scene that set a value
    related   what the piles have to be to one another, by value
    claim     the same in words, and its norm
    mistake   what the control takes for what: values of the scene by the values that they are taken for
    cell_size of a range that is run on the same grid with any effort [m]
    """

    name: str
    title: str
    proves: str
    label: str
    values: tuple[float, ...]
    changes: Callable[[float], dict[str, Any]]
    related: Callable[["Range", Trials], tuple[Measurement, ...]]
    claim: tuple[str, str]
    mistake: tuple[str, dict[float, float]]
    material: str = "mu(I)-LC"
    cell_size: dict[Effort, float] | None = None

    def trials(self, effort: Effort, mistaken: Mapping[float, float] | None = None) -> dict[float, Trial]:
        """A run for each value; of a mistaken range, for the values that it is about."""
        cell_size = (self.cell_size or CELL_SIZE)[effort]
        chosen = {value: value for value in self.values} if mistaken is None else mistaken
        return {
            value: trial(collapse(self.material, cell_size, self.changes(actual)), END[effort])
            for value, actual in chosen.items()
        }

    def measure(self, effort: Effort) -> Evidence:
        """All values."""
        found = self.trials(effort)
        labelled = {self.label.format(value): one for value, one in found.items()}
        return Evidence((*survivals(labelled), *self.related(self, found)), notes=notes(labelled))

    def control(self, effort: Effort) -> tuple[Measurement, ...]:
        """The claim about the piles, with the mistake."""
        return self.related(self, self.trials(Effort.QUICK, self.mistake[1]))

    @property
    def case(self) -> Case:
        """The row as a case."""
        claim, norm = self.claim
        return Case(
            name=self.name,
            title=self.title,
            proves=self.proves,
            reference=f"{SURVIVAL}; {claim}",
            norm=f"{NORM}; {norm}",
            mistake=self.mistake[0],
            measure=self.measure,
            control=self.control,
        )


def same_half_width(reference: float, *others: float) -> Callable[[Range, Trials], tuple[Measurement, ...]]:
    """The half widths of others, where they were run, are that of a reference."""

    def related(row: Range, found: Trials) -> tuple[Measurement, ...]:
        width = found[reference].shape.runout
        return tuple(
            relative_error(f"half width, {row.label.format(value)}", "m", found[value].shape.runout, width, BAND)
            for value in others
            if value in found
        )

    return related


def falling_half_width(row: Range, found: Trials) -> tuple[Measurement, ...]:
    """The largest rise of the half width from one value to the next larger one."""
    widths = [found[value].shape.runout for value in sorted(found)]
    rises = [later / earlier - 1.0 for earlier, later in pairwise(widths)]
    return (upper_bound("rise of the half width with d_p", "1", max(0.0, *rises), 0.0),)


def saturated(row: Range, found: Trials) -> tuple[Measurement, ...]:
    """The roughest floor against one that is as rough as the material."""
    rough, rougher = found[0.7].shape, found[10.0].shape
    return (
        relative_error("half width, friction 10 against 0.7", "m", rougher.runout, rough.runout, BAND),
        relative_error("height, friction 10 against 0.7", "m", rougher.height, rough.height, BAND),
    )


def standing(row: Range, found: Trials) -> tuple[Measurement, ...]:
    """The strongest columns keep their height."""
    return tuple(
        upper_bound(
            f"{row.label.format(value)}: loss of height", "1", 1.0 - found[value].shape.height / START_HEIGHT, BAND
        )
        for value in (20.0, 100.0)
        if value in found
    )


def viscous(alpha: float) -> dict[str, Any]:
    """The law as published with another regularisation rate [1/s]."""
    changes = published_viscous()
    changes["material"]["mu_i_lc_viscous"]["regularisation_rate"] = alpha
    return changes


COARSE = dict.fromkeys(Effort, CELL_SIZE[Effort.QUICK])
HALF_WIDTH = "relative difference of the half width"

RANGES = (
    Range(
        name="overconsolidated_collapses",
        title="collapse of Modified Cam Clay, OCR 1, 4, 20, 100",
        proves="flowing, splitting and standing columns pass through the same return map",
        label="OCR {:g}",
        values=(1.0, 4.0, 20.0, 100.0),
        changes=lambda ratio: {"material.modified_cam_clay.overconsolidation_ratio": ratio},
        related=standing,
        claim=("with OCR 20 and 100 the column stands", "loss of height over height"),
        mistake=("the consolidation of OCR 100 forgotten", {100.0: 1.0}),
        material="MCC OCR 1",
    ),
    Range(
        name="stiffness_range",
        title="collapse of mu(I)-LC, K from 1e4 to 1e9 Pa",
        proves="the step follows the stiffness; a stiff pile does not depend on how stiff it is",
        label="K = {:.0e} Pa",
        values=(1e4, 1e5, 1e6, 1e7, 1e8, 1e9),
        changes=lambda modulus: {"material.mu_i_lc.bulk_modulus": modulus},
        related=same_half_width(1e7, 1e6, 1e8, 1e9),
        claim=("from K = 1e6 Pa, the half width of 1e7 Pa", HALF_WIDTH),
        mistake=("K = 1e4 Pa, less than the weight of the column, taken for stiff", {1e6: 1e4, 1e7: 1e7}),
        # The cost grows with the root of K.
        cell_size=COARSE,
    ),
    Range(
        name="regularisation_range",
        title="collapse of mu_i_lc_viscous, alpha from 0 to 1 1/s",
        proves="the singular viscosity at rest divides by nothing, and a small alpha does not change the pile",
        label="alpha = {:g} 1/s",
        values=(0.0, 1e-6, 1e-4, 1e-2, 1.0),
        changes=viscous,
        related=same_half_width(0.0, 1e-6, 1e-4, 1e-2),
        claim=("up to alpha = 0.01 1/s, the half width without regularisation", HALF_WIDTH),
        mistake=("alpha = 10 1/s, with which the pile flows on, taken for small", {0.0: 0.0, 1e-2: 10.0}),
    ),
    Range(
        name="grain_size_range",
        title="collapse of mu(I)-LC, d_p from 1e-5 to 0.1 m",
        proves="any inertial number passes through the same closed root; large grains flow less far",
        label="d_p = {:g} m",
        values=(1e-5, 1e-4, 1e-3, 1e-2, 1e-1),
        changes=lambda diameter: {"material.mu_i_lc.grain_diameter": diameter},
        related=falling_half_width,
        claim=(
            "mu(I) grows with d_p, so the half width falls with it",
            "largest rise of the half width over the next smaller grains",
        ),
        mistake=("an inertial number that falls with d_p: sizes the wrong way round", {1e-5: 1e-1, 1e-1: 1e-5}),
    ),
    Range(
        name="points_per_cell",
        title="collapse of mu(I)-LC, 1, 4, 9, 16 points per cell",
        proves="coarse and fine quadrature run; from 4 points on the pile does not depend on it",
        label="{:g} points per cell",
        values=(1, 4, 9, 16),
        # Negative: so many, left where they crowd.
        changes=lambda count: {
            "body.0.points_per_cell": abs(int(count)),
            "transfer.volume_projection": count > 0,
        },
        related=same_half_width(16, 4, 9),
        claim=("from 4 points per cell, the half width of 16", HALF_WIDTH),
        mistake=("one point per cell, without volume projection, taken for four", {4: -1, 16: 16}),
        cell_size=COARSE,
    ),
    Range(
        name="floor_friction_range",
        title="collapse of mu(I)-LC on floors with friction 0, 0.7 and 10",
        proves="the Coulomb floor at its two ends: it takes nothing, or no more than the material can pass on",
        label="friction {:g}",
        values=(0.0, 0.7, 10.0),
        changes=lambda coefficient: {"boundary.bottom.coefficient": coefficient},
        related=saturated,
        claim=(
            "rougher than the material the floor makes no difference",
            "relative difference of half width and height",
        ),
        mistake=("a floor without friction taken for the roughest", {0.7: 0.7, 10.0: 0.0}),
    ),
)
CASES = {row.name: row.case for row in RANGES}
