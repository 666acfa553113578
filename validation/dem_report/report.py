"""The whole comparison: scatter of the grains, laws on every column, controls, limits."""

import math
from dataclasses import dataclass
from pathlib import Path

from materials import InputError, SimulationError, get_material
from validation.case import Effort
from validation.dem_report.column import column_of
from validation.dem_report.fitted_laws import FittedLaw, JudgedLaw, fitted
from validation.dem_report.fitting_data import write_data
from validation.dem_report.judged_laws import JUDGED_LAWS
from validation.dem_report.judgement import Announce, Bench, Judgement
from validation.dem_report.reference_set import Ensemble, ReferenceSet, Scatter, scatter
from validation.dem_report.variants import CONTROLS, LIMITS
from validation.grains.distance import Verdict

FLOOR = "glued"
# The column on which controls and limits are run, and the only one of a quick report.
MIDDLE_ASPECT_RATIO = 2.0
CELL_SIZE = {Effort.QUICK: 0.0125, Effort.FULL: 0.00625}
DATA = "data"


@dataclass(frozen=True)
class Report:
    """Everything that the page shows.

    laws        fitted to shear and compression
    unfitted    what kept a law from being fitted, by its title
    judgements  one for each law and column
    controls    must differ
    limits      the first law with one thing changed
    """

    effort: Effort
    cell_size: float
    scatter: list[Scatter]
    columns: list[Ensemble]
    laws: list[FittedLaw]
    unfitted: dict[str, str]
    judgements: list[Judgement]
    controls: list[Judgement]
    limits: list[Judgement]

    @property
    def controls_differ(self) -> bool:
        """Whether every deliberate mistake was noticed; one that could not be run was not."""
        return all(found.comparison is not None and found.verdict is Verdict.DIFFERS for found in self.controls)

    def of_column(self, ensemble: Ensemble) -> list[Judgement]:
        """The judgements on one column."""
        return [found for found in self.judgements if found.ensemble is ensemble]

    def on_columns(self, title: str, wanted: Verdict) -> int:
        """On how many columns a law has a verdict."""
        return sum(found.name == title and found.verdict is wanted for found in self.judgements)


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
    judged_columns = [middle] if is_quick else columns
    return Report(
        effort=effort,
        cell_size=bench.cell_size,
        scatter=scatter(reference),
        columns=judged_columns,
        laws=laws,
        unfitted=unfitted,
        judgements=[bench.judge(law, ensemble) for ensemble in judged_columns for law in laws],
        controls=[bench.judge_variant(laws[0], reference, middle, variant) for variant in CONTROLS],
        limits=[] if is_quick else [bench.judge_variant(laws[0], reference, middle, variant) for variant in LIMITS],
    )


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
