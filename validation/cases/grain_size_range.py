"""Grains from dust to larger than the grid."""

from itertools import pairwise

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, upper_bound
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
VALUES = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1)


def column(diameter: float, effort: Effort) -> Simulation:
    """The paper's column with another grain size."""
    return collapse("mu(I)-LC", CELL_SIZE[effort], {"material.mu_i_lc.grain_diameter": diameter})


def measure(effort: Effort) -> Evidence:
    """All values."""
    found = {f"d_p = {value:g} m": trial(column(value, effort), END[effort]) for value in VALUES}
    return Evidence((*survivals(found), order(found)), notes=notes(found))


def order(found: dict[str, Trial]) -> Measurement:
    """The largest rise of the half width from one grain size to the next larger one."""
    widths = [one.shape.runout for one in found.values()]
    rises = [later / earlier - 1.0 for earlier, later in pairwise(widths)]
    return upper_bound("rise of the half width with d_p", "1", max(0.0, *rises), 0.0)


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Steps far above the stable one, past the refusal."""
    return survival("reckless", reckless_trial(column(0.1, Effort.QUICK), END[Effort.QUICK]))


CASE = Case(
    name="grain_size_range",
    title="collapse of mu(I)-LC, d_p from 1e-5 to 0.1 m",
    proves="any inertial number passes through the same closed root; large grains flow less far",
    reference=f"{SURVIVAL}; mu(I) grows with d_p, so the half width falls with it",
    norm=f"{NORM}; largest rise of the half width over the next smaller grains",
    mistake=RECKLESSNESS,
    measure=measure,
    control=control,
)
