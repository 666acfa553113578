"""Blocks of granular material that fall one metre onto the floor."""

import math

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, relative_error
from grainlaw.validation.cases.hard.survival import NORM, SURVIVAL, notes, survivals, trial
from grainlaw.validation.scenes import DENSITY, PAPER, advance, one_body, rectangle, simulation_of

BAND = 1e-3
DROP, SIZE, GRAVITY = 1.0, 0.2, 9.81
CELL = {Effort.QUICK: 0.025, Effort.FULL: 0.0125}
END = {Effort.QUICK: 0.7, Effort.FULL: 1.0}
# Just before a corner comes within reach of the floor.
FREE_FALL = 0.4
MATERIALS = ("mu(I)-LC", "MCC OCR 4")


def falling(material: str, effort: Effort, gravity: float = GRAVITY) -> Simulation:
    """A block one metre above a rough floor, just in contact."""
    stress = {"kind": "uniform", "pressure": 10.0}
    shape = rectangle(0.9, DROP, SIZE, SIZE)
    scene = one_body(PAPER[material], shape, CELL[effort], [2.0, 1.4], initial_stress=stress)
    floor = {"bottom": {"kind": "friction", "coefficient": 0.7}}
    return simulation_of({**scene, "gravity": [0.0, -gravity], "boundary": floor})


def free_fall(material: str, effort: Effort, gravity: float = GRAVITY) -> Measurement:
    """The kinetic energy before the impact against that of the distance fallen, m g g t^2/2."""
    simulation = falling(material, effort, gravity)
    advance(simulation, FREE_FALL)
    mass = DENSITY * SIZE * SIZE
    exact = 0.5 * mass * (GRAVITY * FREE_FALL) ** 2
    return relative_error(
        f"{material}: kinetic energy of the fall", "J/m", simulation.ledger.kinetic_at_end, exact, BAND
    )


def measure(effort: Effort) -> Evidence:
    """Both materials."""
    found = {material: trial(falling(material, effort), END[effort]) for material in MATERIALS}
    falls = tuple(free_fall(material, effort) for material in MATERIALS)
    speed = f"speed at the floor {math.sqrt(2.0 * GRAVITY * DROP):.2f} m/s"
    return Evidence((*survivals(found), *falls), notes=(speed, *notes(found)))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A fall that loses one thousandth of its speed."""
    return (free_fall("mu(I)-LC", Effort.QUICK, 0.999 * GRAVITY),)


CASE = Case(
    name="falling_block",
    title="block that falls one metre on the floor",
    proves="a free fall is exact; the step follows the stiffening of an impact",
    reference=f"{SURVIVAL}; kinetic energy m (g t)^2/2 after 0.4 s of fall",
    norm=f"{NORM}; relative error of the kinetic energy",
    mistake="gravity 0.1 % too small",
    measure=measure,
    control=control,
)
