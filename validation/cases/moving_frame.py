"""The same collapse seen from a frame that moves: floor and column move together at constant velocity."""

from typing import Any

from grainlaw.validation.case import Case, Effort, Evidence, Measurement, relative_error
from grainlaw.validation.collapses import CELL_SIZE, SCENES, Pile, collapse, pile
from grainlaw.validation.scenes import advance

BAND = 1e-2
END = 1.5
SPEED = 1.0
OBSERVABLES = {"center_of_mass_height": "centre of mass", "runout": "half width", "height": "height"}
MATERIALS = {Effort.QUICK: ("mu(I)-LC",), Effort.FULL: tuple(SCENES)}
LONGER = {"grid.upper": [4.8, 1.0]}


def moving(speed: float) -> dict[str, Any]:
    """Changes of the scene for a frame in which floor and column move along x [m/s]."""
    floor = {"kind": "friction", "coefficient": 0.7, "velocity": speed}
    return {**LONGER, "body.0.velocity": [speed, 0.0], "boundary.bottom": floor}


def final_pile(material: str, effort: Effort, changes: dict[str, Any]) -> tuple[Pile, float]:
    """The pile at the end, and how far its centre of mass has moved [m]."""
    simulation = collapse(material, CELL_SIZE[effort], changes)
    body = simulation.bodies[0]
    start = float(body.positions[0].mean())
    advance(simulation, END)
    return pile(simulation), float(body.positions[0].mean()) - start


def measurements(material: str, effort: Effort, changes: dict[str, Any]) -> tuple[Measurement, ...]:
    """The pile in the moving frame against the pile at rest, and the distance moved."""
    reference, _ = final_pile(material, effort, LONGER)
    found, distance = final_pile(material, effort, changes)
    shapes = [
        relative_error(f"{material}: {label}", "m", getattr(found.shape, name), getattr(reference.shape, name), BAND)
        for name, label in OBSERVABLES.items()
    ]
    return (*shapes, relative_error(f"{material}: distance", "m", distance, SPEED * END, BAND))


def measure(effort: Effort) -> Evidence:
    """The paper's three materials; mu(I)-LC alone in quick."""
    found = [one for material in MATERIALS[effort] for one in measurements(material, effort, moving(SPEED))]
    return Evidence(tuple(found))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A floor that stands still under the moving column."""
    changes = {**LONGER, "body.0.velocity": [SPEED, 0.0]}
    return measurements("mu(I)-LC", Effort.QUICK, changes)


CASE = Case(
    name="moving_frame",
    title="column collapse in a frame that moves at 1 m/s",
    proves="Galilean invariance: neither transfer nor floor knows who moves",
    reference="the same collapse at rest, at t = 1.5 s; cell 0.0125 m (quick: 0.025 m); centre of mass at v t",
    norm="relative difference of centre of mass, runout of 98 % of the mass and height; relative error of the distance",
    mistake="a floor that does not move along",
    measure=measure,
    control=control,
)
