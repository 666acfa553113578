"""The collapse with few and many points."""

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement
from grainlaw.validation.collapses import CELL_SIZE, collapse
from grainlaw.validation.survival import NORM, RECKLESSNESS, SURVIVAL, notes, reckless_trial, survival, survivals, trial

END = {Effort.QUICK: 0.6, Effort.FULL: 1.5}
VALUES = (1, 4, 9, 16)


def column(count: int, effort: Effort) -> Simulation:
    """The paper's column with another number of points per cell; always on the coarse grid."""
    return collapse("mu(I)-LC", CELL_SIZE[Effort.QUICK], {"body.0.points_per_cell": count})


def measure(effort: Effort) -> Evidence:
    """All values."""
    found = {f"{value} points per cell": trial(column(value, effort), END[effort]) for value in VALUES}
    return Evidence(survivals(found), notes=notes(found))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Steps far above the stable one, past the refusal."""
    return survival("reckless", reckless_trial(column(1, Effort.QUICK), END[Effort.QUICK]))


CASE = Case(
    name="points_per_cell",
    title="collapse of mu(I)-LC, 1, 4, 9, 16 points per cell",
    proves="coarse and fine quadrature run; how far the pile depends on it is stated",
    reference=SURVIVAL,
    norm=NORM,
    mistake=RECKLESSNESS,
    measure=measure,
    control=control,
)
