"""The paper's column of every granular law comes to rest."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from materials.registry import get_material
from mpm_core.body import Body
from mpm_core.columns import DENSITY
from mpm_core.simulation import Simulation
from validation.case import Case, Effort, Evidence, Measurement, upper_bound
from validation.collapses import collapse, published_viscous
from validation.scenes import advance
from validation.survival import Trial, survival, trial

KINETIC_BAND = 1e-6
CELL_SIZE = {Effort.QUICK: 0.025, Effort.FULL: 0.00625}
FLOWING, REST = 0.3, 1.5
TIMED_STEPS = 100
# Each with its set `paper`, in the column whose initial stress belongs to it.
LAWS = {
    "drucker_prager": "mu(I)-LC",
    "mu_i_lc": "mu(I)-LC",
    "mu_i_elastoplastic": "mu(I)-LC",
    "mu_i_phi_i": "mu(I)-LC",
    "modified_cam_clay": "MCC OCR 1",
    "mu_i_mcc": "MCC OCR 1",
}


@dataclass(frozen=True)
class Collapse:
    """A collapse led to rest.

    kinetic, released      energies at the end [J/m]
    volume                 over the initial one
    share_without_stress   of the points
    cost                   processor time [ns] of a point and step in flow, transfers included
    """

    trial: Trial
    kinetic: float
    released: float
    volume: float
    share_without_stress: float
    cost: float


def column(law: str) -> dict[str, Any]:
    """Changes to a scene that give its column the law with its set `paper`."""
    parameters = get_material(law).parameter_sets["paper"].parameters
    return {"material": {law: parameters._asdict()}, "body.0.material": law}


def collapsed(simulation: Simulation) -> Collapse:
    """Through the flow, where steps are timed, to rest."""
    body = simulation.bodies[0]
    initial = volume(body)
    advance(simulation, FLOWING)
    cost = nanoseconds_per_step(simulation)
    found = trial(simulation, REST)
    ledger = simulation.ledger
    share = found.limited["points_without_stress"] / body.count
    return Collapse(found, ledger.kinetic, -ledger.potential, volume(body) / initial, share, cost)


def nanoseconds_per_step(simulation: Simulation) -> float:
    """Processor time of a point and step [ns]; for comparison, nothing depends on it."""
    start = time.process_time()
    for _ in range(TIMED_STEPS):
        simulation.step(simulation.stable_step())
    return (time.process_time() - start) / (TIMED_STEPS * simulation.bodies[0].count) * 1e9


def volume(body: Body) -> float:
    """Of all points [m2]."""
    return float(np.sum(body.point_mass / body.points[DENSITY]))


def at_rest(law: str, found: Collapse) -> Measurement:
    """Kinetic energy over the energy released."""
    return upper_bound(f"{law}: kinetic over released energy", "1", found.kinetic / found.released, KINETIC_BAND)


def note(law: str, found: Collapse) -> str:
    """Shape, what the points have come to, and cost."""
    shape = found.trial.shape
    return (
        f"{law}: half width {shape.runout:.3f} m, top {shape.height:.3f} m, centre of mass "
        f"{shape.center_of_mass_height:.3f} m; {found.share_without_stress:.1%} of the points without stress, volume "
        f"{found.volume:.3f} of the initial; {found.trial.steps} steps; {found.cost:.0f} ns per point and step in flow"
    )


def measure(effort: Effort) -> Evidence:
    """Every granular law."""
    results = {law: collapsed(collapse(base, CELL_SIZE[effort], column(law))) for law, base in LAWS.items()}
    measurements = [one for law, found in results.items() for one in (at_rest(law, found), *survival(law, found.trial))]
    return Evidence(tuple(measurements), notes=tuple(note(law, found) for law, found in results.items()))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The law as published, whose viscosity near rest no elastic step can follow."""
    found = collapsed(collapse("mu(I)-LC", CELL_SIZE[Effort.QUICK], published_viscous()))
    return (at_rest("mu_i_lc_viscous", found),)


CASE = Case(
    name="collapse_of_every_law",
    title="the paper's column with every granular law",
    proves="no law breaks down in a large flow, and each comes to rest: solid and fluid in one run",
    reference="finite values, no energy from nowhere, and kinetic energy below 1e-6 of the energy released at 1.5 s",
    norm="kinetic over released energy; those of the hard cases",
    mistake="the published explicit viscosity in place of the elastic predictor",
    measure=measure,
    control=control,
)
