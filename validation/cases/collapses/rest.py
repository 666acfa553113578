"""A collapsed column comes to rest and stays as it is."""

from typing import Any

from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.cases.collapses.column import CELL_SIZE, SCENES, Pile, collapse, pile, published_viscous
from grainlaw.validation.scenes import advance

KINETIC_BAND, CREEP_BAND = 1e-6, 1e-3
REST, WATCH = 1.5, 0.5


def history(material: str, effort: Effort, changes: dict[str, Any] | None = None) -> list[Pile]:
    """The pile over time to the end of the watch, in intervals of 0.05 s; the watch begins at `REST`."""
    simulation = collapse(material, CELL_SIZE[effort], changes)
    found: list[Pile] = []
    advance(simulation, REST, lambda present: found.append(pile(present)), intervals=30)
    advance(simulation, REST + WATCH, lambda present: found.append(pile(present)), intervals=10)
    return found


def measurements(material: str, found: list[Pile]) -> tuple[Measurement, ...]:
    """Kinetic energy when the watch begins, and how fast the pile goes on sinking."""
    start = next(present for present in found if present.time > REST - 1e-9)
    lost = start.shape.height - found[-1].shape.height
    return (
        upper_bound(f"{material}: kinetic over released energy", "1", start.kinetic / start.released, KINETIC_BAND),
        upper_bound(f"{material}: creep of the height", "1/s", lost / start.shape.height / WATCH, CREEP_BAND),
    )


def measure(effort: Effort) -> Evidence:
    """The paper's three materials."""
    results = {material: history(material, effort) for material in SCENES}
    curves = [
        curve(material, [p.time for p in found], [p.kinetic / found[-1].released for p in found])
        for material, found in results.items()
    ]
    figure = Figure("Kinetic energy over the energy released", "time [s]", "energy [1]", tuple(curves), logarithmic="y")
    found = [measurement for material, piles in results.items() for measurement in measurements(material, piles)]
    return Evidence(tuple(found), figures=(figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The law as published, whose viscosity near rest no elastic step can follow."""
    return measurements("mu(I)-LC as published", history("mu(I)-LC", Effort.QUICK, published_viscous()))


CASE = Case(
    name="rest",
    title="collapsed column at rest",
    proves="what rests has no kinetic energy and does not creep",
    reference="rest: kinetic energy below 1e-6 of the energy released 1.5 s after the start, height constant over the "
    "next 0.5 s to 0.1 %/s",
    norm="kinetic over released energy; loss of height over height and time",
    mistake="the published explicit viscosity in place of the elastic predictor",
    measure=measure,
    control=control,
)
