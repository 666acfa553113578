"""The whole comparison: scatter of the grains, laws on every column, controls, limits."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from grainlaw.materials import InputError, SimulationError, get_material
from grainlaw.validation.case import Effort, Evidence
from grainlaw.validation.cases.collapses import aluminium_bars
from grainlaw.validation.dem.judging.column import column_of, flat_friction
from grainlaw.validation.dem.judging.element_verdicts import ElementVerdict, element_verdict
from grainlaw.validation.dem.judging.fitted_laws import FittedLaw, JudgedLaw, fitted
from grainlaw.validation.dem.judging.fitting_data import write_data
from grainlaw.validation.dem.judging.judged_laws import JUDGED_LAWS
from grainlaw.validation.dem.judging.judgement import Announce, Bench, Judgement
from grainlaw.validation.dem.judging.variants import CONTROLS, LIMITS, Variant
from grainlaw.validation.grains.distance import Verdict
from grainlaw.validation.reference.reference_set import Ensemble, ReferenceSet, Scatter, scatter

FLOOR, FLAT = "glued", "flat"
# The laws that are run on flat floors too.
ON_FLAT_FLOORS = ("mu_i_lc", "mu_i_phi_i", "mu_i_state")
# The column on which controls and limits are run, and the only one of a quick report.
MIDDLE_ASPECT_RATIO = 2.0
CELL_SIZE = {Effort.QUICK: 0.0125, Effort.FULL: 0.00625}
DATA = "data"


@dataclass(frozen=True)
class Report:
    """Everything that the page shows.

    laws        fitted to shear and compression
    unfitted    what kept a law from being fitted, by its title
    elements    each law in the element tests
    judgements  one for each law and column
    flat        some laws on flat floors, with the friction of the plane that plane shear over it shows
    flat_friction  that friction
    controls    deliberate mistakes, which must be noticed
    limits      laws with one thing changed
    experiment  aluminium bars, against their published deposit; None in a quick report
    """

    effort: Effort
    cell_size: float
    scatter: list[Scatter]
    columns: list[Ensemble]
    laws: list[FittedLaw]
    unfitted: dict[str, str]
    elements: list[ElementVerdict]
    judgements: list[Judgement]
    flat: list[Judgement]
    flat_friction: float
    controls: list[Judgement]
    limits: list[Judgement]
    experiment: Evidence | None

    @property
    def missed(self) -> list[Judgement]:
        """The deliberate mistakes that were not noticed; one that could not be run was not."""
        return [found for found in self.controls if not _noticed(found)]

    @property
    def flat_columns(self) -> list[Ensemble]:
        """The columns on flat floors."""
        return list({found.ensemble.case: found.ensemble for found in self.flat}.values())

    def of_column(self, ensemble: Ensemble) -> list[Judgement]:
        """The judgements on one column."""
        return [found for found in (*self.judgements, *self.flat) if found.ensemble is ensemble]


def make_report(reference: ReferenceSet, folder: Path, effort: Effort, announce: Announce) -> Report:
    """Fit, run and compare; a quick report runs the first law on one column with coarse cells."""
    columns = reference.columns(FLOOR)
    if not columns:
        raise InputError(f"the reference set holds no columns on a {FLOOR} floor")
    middle = min(columns, key=lambda found: abs(math.log(found.aspect_ratio / MIDDLE_ASPECT_RATIO)))
    is_quick = effort is Effort.QUICK
    column = column_of(middle)
    write_data(reference, folder / DATA, column.grain_density, column.grain_diameter)
    laws, unfitted = _fitted(JUDGED_LAWS[:1] if is_quick else JUDGED_LAWS, folder / DATA, announce)
    if not laws:
        raise InputError(f"no law could be fitted: {'; '.join(unfitted.values())}")
    bench = Bench(folder, CELL_SIZE[effort], announce)
    judged_columns = [middle] if is_quick else [*columns, *reference.cylinders(FLOOR)]
    flat_columns = [] if is_quick else reference.columns(FLAT)
    plane = flat_friction(reference)
    return Report(
        effort=effort,
        cell_size=bench.cell_size,
        scatter=scatter(reference),
        columns=judged_columns,
        laws=laws,
        unfitted=unfitted,
        elements=[element_verdict(law, folder / DATA) for law in laws],
        judgements=[bench.judge(law, ensemble) for ensemble in judged_columns for law in laws],
        flat=[
            bench.judge(law, ensemble, plane)
            for ensemble in flat_columns
            for law in laws
            if law.judged.law in ON_FLAT_FLOORS
        ],
        flat_friction=plane,
        controls=_varied(bench, reference, laws, [middle] if is_quick else columns, CONTROLS),
        limits=[] if is_quick else _varied(bench, reference, laws, columns, LIMITS),
        experiment=None if is_quick else aluminium_bars.measure(Effort.FULL),
    )


def _noticed(control: Judgement) -> bool:
    order = list(Verdict)
    wanted = control.variant.noticed if control.variant else Verdict.DIFFERS
    return control.comparison is not None and order.index(control.verdict) >= order.index(wanted)


def _varied(
    bench: Bench,
    reference: ReferenceSet,
    laws: list[FittedLaw],
    columns: list[Ensemble],
    variants: Sequence[Variant],
) -> list[Judgement]:
    """The variants of the laws that were fitted, on the columns that are there."""
    by_name = {found.judged.law: found for found in laws}
    by_ratio = {round(found.aspect_ratio, 2): found for found in columns}
    return [
        bench.judge_variant(by_name[variant.law], reference, by_ratio[variant.aspect_ratio], variant)
        for variant in variants
        if variant.law in by_name and variant.aspect_ratio in by_ratio
    ]


def _fitted(judged: tuple[JudgedLaw, ...], folder: Path, announce: Announce) -> tuple[list[FittedLaw], dict[str, str]]:
    laws, unfitted = [], {}
    for law in judged:
        announce(f"fitting {law.title}")
        try:
            get_material(law.law)
            laws.append(fitted(law, folder))
        except (InputError, SimulationError) as error:
            unfitted[law.title] = str(error)
    return laws, unfitted
