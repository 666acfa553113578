"""The collapse with bulk moduli over five orders of magnitude."""

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
VALUES = (1e4, 1e5, 1e6, 1e7, 1e8, 1e9)
BAND = 5e-2
REFERENCE, STIFF = 1e7, (1e6, 1e8, 1e9)


def column(modulus: float, effort: Effort) -> Simulation:
    """The paper's column with another K; always on the coarse grid, since the cost grows with the root of K."""
    return collapse("mu(I)-LC", CELL_SIZE[Effort.QUICK], {"material.mu_i_lc.bulk_modulus": modulus})


def measure(effort: Effort) -> Evidence:
    """All values."""
    found = {f"K = {value:.0e} Pa": trial(column(value, effort), END[effort]) for value in VALUES}
    return Evidence((*survivals(found), *indifference(found)), notes=notes(found))


def indifference(found: dict[str, Trial]) -> tuple[Measurement, ...]:
    """Half widths of the stiff piles against one another."""
    widths = {value: found[f"K = {value:.0e} Pa"].shape.runout for value in VALUES}
    return tuple(
        relative_error(f"half width, K = {value:.0e} Pa", "m", widths[value], widths[REFERENCE], BAND)
        for value in STIFF
    )


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Steps far above the stable one, past the refusal."""
    return survival("reckless", reckless_trial(column(1e6, Effort.QUICK), END[Effort.QUICK]))


CASE = Case(
    name="stiffness_range",
    title="collapse of mu(I)-LC, K from 1e4 to 1e9 Pa",
    proves="the step follows the stiffness; a stiff pile does not depend on how stiff it is",
    reference=f"{SURVIVAL}; from K = 1e6 Pa, the half width of 1e7 Pa",
    norm=f"{NORM}; relative difference of the half width",
    mistake=RECKLESSNESS,
    measure=measure,
    control=control,
)
