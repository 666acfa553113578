"""Steps exactly at the stability limit, and five per cent above it."""

import tempfile
from pathlib import Path
from typing import Any

from grainlaw.materials import InputError
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.mpm_core.stepping.run import run
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, upper_bound
from grainlaw.validation.cases.collapses.column import CELL_SIZE, SCENES, collapse
from grainlaw.validation.cases.hard.survival import NORM, SURVIVAL, Observe, notes, survival, survivals, trial
from grainlaw.validation.scenes import shipped_simulation, simulation_of

END = {Effort.QUICK: 0.5, Effort.FULL: 1.5}
DISCS_END = 3.6
# Past the stable step, where a run has to break.
RECKLESS = 10.0
AT_LIMIT: dict[str, Any] = {"time.safety": 1.0}
ABOVE = 1.05


def column(material: str, effort: Effort) -> Simulation:
    """The paper's column with the whole stable step."""
    return collapse(material, CELL_SIZE[effort], AT_LIMIT)


def discs() -> Simulation:
    """The elastic discs with the whole stable step in place of the published one."""
    content = shipped_simulation("two_discs").scene.model_dump(mode="json", exclude_none=True)
    del content["time"]["step"]
    content["time"]["safety"] = 1.0
    return simulation_of(content)


def refused(above: float) -> Measurement:
    """A step set by hand; 0 if the run refuses it."""
    simulation = shipped_simulation("two_discs")
    step = above * simulation.critical_time_step()
    content = simulation.scene.model_dump(mode="json", exclude_none=True)
    content["time"] |= {"step": step, "end": 10.0 * step}
    content["output"] |= {"vtu": False, "pictures": False}
    with tempfile.TemporaryDirectory() as folder:
        try:
            run(Scene.from_dict(content), Path(folder) / "run")
        except InputError as error:
            accepted = float("above the stable step" not in str(error))
        else:
            accepted = 1.0
    return upper_bound(f"step of {above:g} times the limit is accepted", "1", accepted, 0.0)


def recklessly(simulation: Simulation, end: float, observe: Observe) -> None:
    """Lead a simulation in steps that a run would refuse."""
    while simulation.time < end:
        simulation.step(RECKLESS * simulation.critical_time_step())
        observe(simulation)


def measure(effort: Effort) -> Evidence:
    """Collapses and the collision of discs at the limit; a step above it."""
    trials = {material: trial(column(material, effort), END[effort]) for material in SCENES}
    trials["two elastic discs"] = trial(discs(), DISCS_END)
    return Evidence((*survivals(trials), refused(ABOVE)), notes=notes(trials))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Steps far above the limit, past the refusal."""
    return survival("reckless", trial(column("mu(I)-LC", Effort.QUICK), END[Effort.QUICK], recklessly))


CASE = Case(
    name="step_limit",
    title="step at the stability limit, and 5 % above",
    proves="the limit is one: at it runs hold, above it they are refused",
    reference=f"{SURVIVAL}, at safety 1; a step 5 % above the stable one is refused",
    norm=NORM,
    mistake="steps ten times the stable one, past the refusal",
    measure=measure,
    control=control,
)
