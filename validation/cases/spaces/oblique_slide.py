"""A stiff block slides over a floor in three dimensions, in a direction that no axis of the grid has."""

import math
from dataclasses import dataclass
from typing import Any

from grainlaw.validation.case import Case, Effort, Evidence, Measurement, relative_error, upper_bound
from grainlaw.validation.cases.exact.sliding_block import ANGLE, END, FRICTION, GRAVITY, exact_distance
from grainlaw.validation.scenes import advance, shipped_simulation

BAND = 5e-3
# Of gravity along the floor, from x towards y.
DIRECTION = math.radians(30.0)
CHANGES: dict[Effort, dict[str, Any]] = {Effort.QUICK: {"grid.cell_size": 0.05}, Effort.FULL: {}}


@dataclass(frozen=True)
class Slide:
    """Ways of the centre of mass along and across the direction of gravity [m], and the work of friction [J]."""

    along: float
    across: float
    friction: float


def slide(changes: dict[str, Any]) -> tuple[Slide, float]:
    """The slide of a block that starts with the shear stress of steady sliding (`exact.sliding_block`); its mass."""
    simulation = shipped_simulation("block_slide_3d", changes)
    body = simulation.bodies[0]
    _, _, vertical, _, yz, xz = body.stress
    xz[:], yz[:] = -FRICTION * vertical * math.cos(DIRECTION), -FRICTION * vertical * math.sin(DIRECTION)
    start = body.positions.mean(axis=1)
    advance(simulation, END)
    x, y, _ = body.positions.mean(axis=1) - start
    cosine, sine = math.cos(DIRECTION), math.sin(DIRECTION)
    found = Slide(x * cosine + y * sine, y * cosine - x * sine, simulation.ledger.wall_friction)
    return found, float(body.masses.sum())


def measurements(changes: dict[str, Any]) -> tuple[Measurement, ...]:
    """Distance, direction, and the friction work of the ledger."""
    found, mass = slide(changes)
    work = FRICTION * mass * GRAVITY * math.cos(ANGLE) * exact_distance(END)
    return (
        relative_error(f"distance after {END:g} s", "m", found.along, exact_distance(END), BAND),
        upper_bound("way across over way along", "1", found.across / found.along, BAND),
        relative_error("friction work of the ledger", "J", found.friction, work, BAND),
    )


def measure(effort: Effort) -> Evidence:
    """The shipped scene; at quick effort on cells of twice the size."""
    return Evidence(measurements(CHANGES[effort]))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A floor whose friction is 3 % too large, and gravity that is turned by one degree more."""
    coarse, along = CHANGES[Effort.QUICK], GRAVITY * math.sin(ANGLE)
    turned = DIRECTION + math.radians(1.0)
    gravity = [along * math.cos(turned), along * math.sin(turned), -GRAVITY * math.cos(ANGLE)]
    distance, _, work = measurements({**coarse, "boundary.bottom.coefficient": 1.03 * FRICTION})
    _, direction, _ = measurements({**coarse, "gravity": gravity})
    return distance, direction, work


CASE = Case(
    name="oblique_slide",
    title="block sliding down a plane of 30 degrees in 3D, 30 degrees off the grid",
    proves="friction acts against the sliding, in any direction along the floor, and the ledger counts its work",
    reference="x = g (sin theta - mu cos theta) t^2/2 in the direction of gravity; work mu m g cos(theta) x",
    norm="relative error of distance and work; way across over way along",
    mistake="friction coefficient of the floor 3 % too large; gravity turned by one degree",
    measure=measure,
    control=control,
)
