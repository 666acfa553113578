"""The paper's column of every granular law comes to rest; with what each law costs, in one table."""

import time
from typing import Any

import numpy as np

from grainlaw.materials.conformance.code import nanoseconds_per_update
from grainlaw.materials.conformance.subject import Subject
from grainlaw.materials.registry import get_material
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, upper_bound
from grainlaw.validation.cases.collapses.column import collapse, published_viscous
from grainlaw.validation.cases.collapses.law_collapses import Collapse, kept
from grainlaw.validation.cases.hard.survival import ENERGY_BAND, trial
from grainlaw.validation.scenes import advance

KINETIC_BAND = 1e-6
CELL_SIZE = {Effort.QUICK: 0.025, Effort.FULL: 0.00625}
FLOWING, REST = 0.3, 1.5
# The pile rings with a period of some 0.06 s; its kinetic energy at one instant is a matter of phase.
RINGING, INSTANTS = 0.1, 25
TIMED_STEPS = 100
# Each with its set `paper`, in the column whose initial stress belongs to it.
LAWS = {
    "drucker_prager": "mu(I)-LC",
    "mu_i_lc": "mu(I)-LC",
    "mu_i_elastoplastic": "mu(I)-LC",
    "mu_i_phi_i": "mu(I)-LC",
    "mu_i_state": "mu(I)-LC",
    "modified_cam_clay": "MCC OCR 1",
    "mu_i_mcc": "MCC OCR 1",
}
# These neither pile up nor rest; of them the table has the cost alone.
OTHER_LAWS = ("linear_elastic", "mu_i_lc_viscous", "neo_hookean", "newtonian")


def column(law: str) -> dict[str, Any]:
    """Changes to a scene that give its column the law with its set `paper`."""
    parameters = get_material(law).parameter_sets["paper"].parameters
    return {"material": {law: parameters._asdict()}, "body.0.material": law}


def collapsed(simulation: Simulation) -> Collapse:
    """Through the flow, where steps are timed, to rest, where the largest kinetic energy is taken."""
    body, ledger = simulation.bodies[0], simulation.ledger
    initial, start = volume(body), time.process_time()
    advance(simulation, FLOWING)
    cost = nanoseconds_per_step(simulation)
    settling = trial(simulation, REST - RINGING)
    kinetic: list[float] = []
    if not settling.message:
        advance(simulation, REST, lambda present: kinetic.append(present.ledger.kinetic), INSTANTS)
    found = trial(simulation, REST)
    return Collapse(
        kinetic=max(kinetic, default=ledger.kinetic) / -ledger.potential,
        missing=found.missing,
        not_finite=found.not_finite,
        created=max(settling.created, found.created),
        runout=found.shape.runout,
        height=found.shape.height,
        center_of_mass_height=found.shape.center_of_mass_height,
        volume=volume(body) / initial,
        share_without_stress=found.limited["points_without_stress"] / body.count,
        points=body.count,
        steps=found.steps,
        cost=cost,
        processor_time=time.process_time() - start,
        message=settling.message or found.message,
    )


def nanoseconds_per_step(simulation: Simulation) -> float:
    """Processor time of a point and step [ns]; for comparison, nothing depends on it."""
    start = time.process_time()
    for _ in range(TIMED_STEPS):
        simulation.step(simulation.adaptive_step())
    return (time.process_time() - start) / (TIMED_STEPS * simulation.bodies[0].count) * 1e9


def volume(body: Body) -> float:
    """Of all points [m2]."""
    return float(np.sum(body.volume))


def measured(law: str, effort: Effort) -> Collapse:
    """The collapse of a law; in full it is kept, so that a run that was stopped goes on with the next law."""
    size = CELL_SIZE[effort]

    def run() -> Collapse:
        return collapsed(collapse(LAWS[law], size, column(law)))

    return run() if effort is Effort.QUICK else kept(law, size, run)


def bounds(law: str, found: Collapse) -> tuple[Measurement, ...]:
    """Kinetic over released energy at rest; the end is reached, all is finite, no energy comes from nowhere."""
    return (
        upper_bound(f"{law}: kinetic over released energy", "1", found.kinetic, KINETIC_BAND),
        upper_bound(f"{law}: time not reached", "1", found.missing, 0.0),
        upper_bound(f"{law}: points that are not finite", "1", found.not_finite, 0.0),
        upper_bound(f"{law}: energy created over released", "1", found.created, ENERGY_BAND),
    )


def cost_of_update(law: str) -> float:
    """Processor time of one update [ns], with the set `paper` where there is one."""
    sets = get_material(law).parameter_sets
    return nanoseconds_per_update(Subject(get_material(law), "paper" if "paper" in sets else next(iter(sets)), 1))


HEADING = (
    "| law | ns per update | ns per point and step in flow | steps | processor time [s] | kinetic / released at rest "
    "| not finite | half width [m] | top [m] | volume / initial | without stress |"
)


def table(results: dict[str, Collapse]) -> tuple[str, ...]:
    """What each law costs and comes to, a line each."""
    lines = [HEADING, "|" + " --- |" * (HEADING.count("|") - 1)]
    for law, found in results.items():
        lines.append(
            f"| {law} | {cost_of_update(law):.0f} | {found.cost:.0f} | {found.steps} | {found.processor_time:.0f} "
            f"| {found.kinetic:.1e} | {found.not_finite} | {found.runout:.3f} | {found.height:.3f} "
            f"| {found.volume:.3f} | {found.share_without_stress:.1%} |"
        )
    return (*lines, *(f"| {law} | {cost_of_update(law):.0f} |" + " |" * 9 for law in OTHER_LAWS))


def measure(effort: Effort) -> Evidence:
    """Every granular law."""
    results = {law: measured(law, effort) for law in LAWS}
    measurements = [one for law, found in results.items() for one in bounds(law, found)]
    return Evidence(tuple(measurements), notes=table(results))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The law as published, whose viscosity near rest no elastic step can follow."""
    found = collapsed(collapse("mu(I)-LC", CELL_SIZE[Effort.QUICK], published_viscous()))
    return bounds("mu_i_lc_viscous", found)[:1]


CASE = Case(
    name="collapse_of_every_law",
    title="the paper's column with every granular law",
    proves="no law breaks down in a large flow, and each comes to rest: solid and fluid in one run",
    reference="finite values, no energy from nowhere, and kinetic energy below 1e-6 of the energy released, at all of "
    f"the last {RINGING:g} s before 1.5 s",
    norm="largest kinetic over released energy; those of the hard cases",
    mistake="the published explicit viscosity in place of the elastic predictor",
    measure=measure,
    control=control,
)
