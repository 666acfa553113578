"""Columns of Modified Cam Clay, from normally consolidated to OCR 100."""

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement
from grainlaw.validation.collapses import CELL_SIZE, collapse
from grainlaw.validation.survival import NORM, RECKLESSNESS, SURVIVAL, notes, reckless_trial, survival, survivals, trial

END = {Effort.QUICK: 0.6, Effort.FULL: 1.5}
VALUES = (1.0, 4.0, 20.0, 100.0)


def column(ratio: float, effort: Effort) -> Simulation:
    """The paper's column with another OCR."""
    return collapse("MCC OCR 1", CELL_SIZE[effort], {"material.modified_cam_clay.overconsolidation_ratio": ratio})


def measure(effort: Effort) -> Evidence:
    """All values."""
    found = {f"OCR {value:g}": trial(column(value, effort), END[effort]) for value in VALUES}
    return Evidence(survivals(found), notes=notes(found))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Steps far above the stable one, past the refusal."""
    return survival("reckless", reckless_trial(column(100.0, Effort.QUICK), END[Effort.QUICK]))


CASE = Case(
    name="overconsolidated_collapses",
    title="collapse of Modified Cam Clay, OCR 1, 4, 20, 100",
    proves="flowing, splitting and standing columns pass through the same return map",
    reference=SURVIVAL,
    norm=NORM,
    mistake=RECKLESSNESS,
    measure=measure,
    control=control,
)
