"""A column twenty times as high as wide, and a layer one cell thick."""

from typing import Any

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, upper_bound
from grainlaw.validation.cases.hard.survival import NORM, SURVIVAL, notes, survivals, trial
from grainlaw.validation.scenes import PAPER, advance, one_body, rectangle, simulation_of

SETTLEMENT_BAND = 1e-2
END = {Effort.QUICK: 0.5, Effort.FULL: 1.5}
CELL = {Effort.QUICK: 0.025, Effort.FULL: 0.0125}
WIDTH, ASPECT, LENGTH = 0.05, 20.0, 0.5
FRICTION = 0.7
MATERIALS = ("mu(I)-LC", "MCC OCR 1")


def scene(
    material: str, cell_size: float, size: tuple[float, float], half_domain: float, friction: float = FRICTION
) -> dict[str, Any]:
    """A rectangle of width and height on a rough floor, in the middle of the domain."""
    shape = rectangle(half_domain - 0.5 * size[0], 0.0, *size)
    upper = [2.0 * half_domain, 1.1]
    resting = one_body(PAPER[material], shape, cell_size, upper, initial_stress={"kind": "geostatic"})
    floor = {"bottom": {"kind": "friction", "coefficient": friction}}
    return {**resting, "gravity": [0.0, -9.81], "boundary": floor}


def slender(material: str, effort: Effort) -> Simulation:
    """The column, two cells wide on the coarse grid."""
    return simulation_of(scene(material, CELL[effort], (WIDTH, ASPECT * WIDTH), half_domain=2.5))


def thin(material: str, effort: Effort, friction: float = FRICTION) -> Simulation:
    """The layer."""
    return simulation_of(scene(material, CELL[effort], (LENGTH, CELL[effort]), half_domain=0.5, friction=friction))


def settlement(material: str, effort: Effort, friction: float = FRICTION) -> Measurement:
    """How far the centre of mass of the layer sinks, over the thickness: it has nowhere to go but its ends."""
    simulation = thin(material, effort, friction)
    body = simulation.bodies[0]
    start = float(body.positions[1].mean())
    advance(simulation, END[effort])
    sunk = (start - float(body.positions[1].mean())) / CELL[effort]
    return upper_bound(f"thin layer, {material}: settlement over thickness", "1", sunk, SETTLEMENT_BAND)


def measure(effort: Effort) -> Evidence:
    """Both shapes, both materials."""
    trials = {f"slender column, {name}": trial(slender(name, effort), END[effort]) for name in MATERIALS}
    trials |= {f"thin layer, {name}": trial(thin(name, effort), END[effort]) for name in MATERIALS}
    rest = tuple(settlement(name, effort) for name in MATERIALS)
    return Evidence((*survivals(trials), *rest), notes=notes(trials))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A layer on a floor that does not hold its ends."""
    return (settlement("mu(I)-LC", Effort.QUICK, friction=0.0),)


CASE = Case(
    name="slender_and_thin",
    title="column of aspect ratio 20, layer one cell thick",
    proves="bodies at the limit of the resolution neither break the run nor sink into the floor",
    reference=f"{SURVIVAL}; a flat layer on a rough floor stays",
    norm=f"{NORM}; settlement over thickness",
    mistake="a floor without friction",
    measure=measure,
    control=control,
)
