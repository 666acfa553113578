"""The published viscous law with its regularisation from none to 1/s."""

from typing import Any

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement
from grainlaw.validation.collapses import CELL_SIZE, collapse, published_viscous
from grainlaw.validation.survival import NORM, RECKLESSNESS, SURVIVAL, notes, reckless_trial, survival, survivals, trial

END = {Effort.QUICK: 0.6, Effort.FULL: 1.5}
VALUES = (0.0, 1e-6, 1e-4, 1e-2, 1.0)


def viscous(alpha: float) -> dict[str, Any]:
    """Changes of the scene that give the law as published with another regularisation rate [1/s]."""
    changes = published_viscous()
    changes["material"]["mu_i_lc_viscous"]["regularisation_rate"] = alpha
    return changes


def column(alpha: float, effort: Effort) -> Simulation:
    """The paper's column with the law as published and another alpha."""
    return collapse("mu(I)-LC", CELL_SIZE[effort], viscous(alpha))


def measure(effort: Effort) -> Evidence:
    """All values."""
    found = {f"alpha = {value:g} 1/s": trial(column(value, effort), END[effort]) for value in VALUES}
    return Evidence(survivals(found), notes=notes(found))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Steps far above the stable one, past the refusal."""
    return survival("reckless", reckless_trial(column(0.0, Effort.QUICK), END[Effort.QUICK]))


CASE = Case(
    name="regularisation_range",
    title="collapse of mu_i_lc_viscous, alpha from 0 to 1 1/s",
    proves="the singular viscosity at rest divides by nothing",
    reference=SURVIVAL,
    norm=NORM,
    mistake=RECKLESSNESS,
    measure=measure,
    control=control,
)
