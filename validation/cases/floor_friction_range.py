"""Floors without friction and with more than any material has."""

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, relative_error
from grainlaw.validation.collapses import CELL_SIZE, collapse
from grainlaw.validation.survival import (
    NORM,
    RECKLESSNESS,
    SURVIVAL,
    Trial,
    notes,
    reckless_trial,
    survival,
    survivals,
    trial,
)

END = {Effort.QUICK: 0.6, Effort.FULL: 1.5}
VALUES = (0.0, 0.7, 10.0)
BAND = 5e-2


def column(coefficient: float, effort: Effort) -> Simulation:
    """The paper's column on another floor."""
    return collapse("mu(I)-LC", CELL_SIZE[effort], {"boundary.bottom.coefficient": coefficient})


def measure(effort: Effort) -> Evidence:
    """All values."""
    found = {f"friction {value:g}": trial(column(value, effort), END[effort]) for value in VALUES}
    return Evidence((*survivals(found), *saturation(found)), notes=notes(found))


def saturation(found: dict[str, Trial]) -> tuple[Measurement, ...]:
    """The roughest floor against one that is as rough as the material."""
    rough, rougher = found["friction 0.7"].shape, found["friction 10"].shape
    return (
        relative_error("half width, friction 10 against 0.7", "m", rougher.runout, rough.runout, BAND),
        relative_error("height, friction 10 against 0.7", "m", rougher.height, rough.height, BAND),
    )


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Steps far above the stable one, past the refusal."""
    return survival("reckless", reckless_trial(column(0.0, Effort.QUICK), END[Effort.QUICK]))


CASE = Case(
    name="floor_friction_range",
    title="collapse of mu(I)-LC on floors with friction 0, 0.7 and 10",
    proves="the Coulomb floor at its two ends: it takes nothing, or no more than the material can pass on",
    reference=f"{SURVIVAL}; rougher than the material the floor makes no difference",
    norm=f"{NORM}; relative difference of half width and height",
    mistake=RECKLESSNESS,
    measure=measure,
    control=control,
)
