"""The same collapse with scene and gravity turned by a quarter: the floor is the left side of the domain."""

from typing import Any

import numpy as np

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, upper_bound
from grainlaw.validation.collapses import CELL_SIZE, SCENES, collapse
from grainlaw.validation.scenes import advance, in_order_of_generation

# Sums over a stencil run along x first; turned, they have another order and another round-off.
BAND = 1e-9
SIZE = 0.9
END = {Effort.QUICK: 0.3, Effort.FULL: 0.6}
MATERIALS = {Effort.QUICK: ("mu(I)-LC",), Effort.FULL: tuple(SCENES)}
LENGTH = 3.2
TURNED: dict[str, Any] = {
    "gravity": [-9.8, 0.0],
    "grid.upper": [1.0, LENGTH],
    "boundary.bottom": {"kind": "free_slip"},
    "boundary.left": {"kind": "friction", "coefficient": 0.7},
    "body.0.shape": {"kind": "rectangle", "lower": [0.0, 1.45], "upper": [0.9, 1.75]},
}


def turn(simulation: Simulation, upright: Simulation) -> None:
    """Give the points of the turned column what those of the upright one have: (x, y) -> (y, L - x)."""
    turned, model = simulation.bodies[0], upright.bodies[0]
    turned.points[:] = model.points
    x, y = model.positions
    turned.positions = np.array([y, LENGTH - x])
    xx, yy, zz, xy = model.stress
    turned.stress = np.array([yy, xx, zz, -xy])
    simulation.measure_signals()


def difference(material: str, effort: Effort, changes: dict[str, Any]) -> Measurement:
    """The largest distance between the points of both collapses, turned back, over the height of the column."""
    upright = collapse(material, CELL_SIZE[effort])
    turned = collapse(material, CELL_SIZE[effort], {**TURNED, **changes})
    turn(turned, upright)
    for simulation in (upright, turned):
        advance(simulation, END[effort])
    x, y = in_order_of_generation(upright.bodies[0], upright.bodies[0].positions)
    turned_x, turned_y = in_order_of_generation(turned.bodies[0], turned.bodies[0].positions)
    distance = float(np.hypot(turned_x - y, LENGTH - turned_y - x).max())
    return upper_bound(f"{material}: largest distance over height", "1", distance / SIZE, BAND)


def measure(effort: Effort) -> Evidence:
    """The paper's three materials; mu(I)-LC alone in quick."""
    return Evidence(tuple(difference(material, effort, {}) for material in MATERIALS[effort]))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Gravity that is off by a hundred thousandth of itself."""
    return (difference("mu(I)-LC", Effort.QUICK, {"gravity": [-9.8, 1e-4]}),)


CASE = Case(
    name="turned_scene",
    title="column collapse, scene and gravity turned by 90 degrees",
    proves="no axis is special: transfer, stress and walls are the same along x and y",
    reference="the same collapse upright, point by point; cell 0.0125 m (quick: 0.025 m)",
    norm="largest distance between corresponding points over the height of the column",
    mistake="gravity tilted by 1e-5",
    measure=measure,
    control=control,
)
