"""A symmetric column collapses symmetrically."""

from typing import Any

import numpy as np

from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.collapses import CELL_SIZE, SCENES, collapse
from grainlaw.validation.scenes import advance, in_order_of_generation

BAND = 1e-9
AXIS, SIZE, COLUMN = 1.6, 0.9, (0.3, 0.9)
END = {Effort.QUICK: 0.4, Effort.FULL: 1.5}
TILTED = {"gravity": [1e-6, -9.8]}


def asymmetry(material: str, effort: Effort, changes: dict[str, Any] | None = None) -> list[tuple[float, float]]:
    """Times [s] and the largest distance of a point from its partner's mirror image, over the column's height."""
    cell = CELL_SIZE[effort]
    simulation = collapse(material, cell, changes)
    body = simulation.bodies[0]
    shape = [round(length / (0.5 * cell)) for length in COLUMN]
    found: list[tuple[float, float]] = []

    def observe(present: Any) -> None:
        x = in_order_of_generation(body, body.positions[0]).reshape(shape) - AXIS
        y = in_order_of_generation(body, body.positions[1]).reshape(shape)
        found.append((present.time, float(np.hypot(x + x[::-1], y - y[::-1]).max()) / SIZE))

    advance(simulation, END[effort], observe, intervals=25)
    return found


def largest(material: str, found: list[tuple[float, float]]) -> Measurement:
    """The largest asymmetry over time."""
    return upper_bound(f"{material}: largest asymmetry", "1", max(value for _, value in found), BAND)


def measure(effort: Effort) -> Evidence:
    """The paper's three materials."""
    results = {material: asymmetry(material, effort) for material in SCENES}
    curves = [curve(name, [t for t, _ in found], [max(a, 1e-17) for _, a in found]) for name, found in results.items()]
    figure = Figure("Asymmetry", "time [s]", "distance over height [1]", tuple(curves), logarithmic="y")
    return Evidence(tuple(largest(name, found) for name, found in results.items()), figures=(figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Gravity out of plumb by a ten-millionth."""
    return (largest("mu(I)-LC", asymmetry("mu(I)-LC", Effort.QUICK, TILTED)),)


CASE = Case(
    name="mirror_symmetry",
    title="symmetry of a collapse",
    proves="nothing in transfer, walls or sorting prefers a side",
    reference="the mirror image of the other half",
    norm="largest distance of a point from the mirror image of its partner, over the height of the column",
    mistake="gravity out of plumb by 1e-7",
    measure=measure,
    control=control,
)
