"""The same collapse with the column at another place relative to the nodes of the grid."""

from typing import Any

from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.collapses import CELL_SIZE, SCENES, Pile, collapse, pile
from grainlaw.validation.scenes import advance

BAND = 1e-2
SHIFT = 0.37
END = 1.5
OBSERVABLES = ("center_of_mass_height", "runout", "height")
MATERIALS = {Effort.QUICK: ("mu(I)-LC",), Effort.FULL: tuple(SCENES)}


def final_pile(material: str, effort: Effort, shift: float, changes: dict[str, Any] | None = None) -> Pile:
    """The pile at the end, of a column whose points start `shift` cells off their lattice."""
    simulation = collapse(material, CELL_SIZE[effort], changes)
    simulation.bodies[0].positions[0] += shift * simulation.grid.cell_size
    advance(simulation, END)
    return pile(simulation)


def measurements(material: str, shifted: Pile, reference: Pile) -> tuple[Measurement, ...]:
    """Shape of the shifted pile against the other."""
    return tuple(
        relative_error(
            f"{material}: {name.replace('_', ' ')}",
            "m",
            getattr(shifted.shape, name),
            getattr(reference.shape, name),
            BAND,
        )
        for name in OBSERVABLES
    )


def measure(effort: Effort) -> Evidence:
    """The paper's three materials; mu(I)-LC alone in quick."""
    found: list[Measurement] = []
    for material in MATERIALS[effort]:
        reference = final_pile(material, effort, 0.0)
        found += measurements(material, final_pile(material, effort, SHIFT), reference)
    figure = Figure(
        "Change by a shift of 0.37 cells",
        "measurement",
        "relative change [1]",
        (curve("error", range(1, len(found) + 1), [measurement.error for measurement in found]),),
    )
    return Evidence(tuple(found), figures=(figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A shifted column on a smoother floor."""
    reference = final_pile("mu(I)-LC", Effort.QUICK, 0.0)
    changes = {"boundary.bottom.coefficient": 0.5}
    return measurements("mu(I)-LC", final_pile("mu(I)-LC", Effort.QUICK, SHIFT, changes), reference)


CASE = Case(
    name="shifted_column",
    title="column collapse, shifted by 0.37 cells",
    proves="the pile does not depend on where the column stands on the grid",
    reference="the same collapse without the shift, at t = 1.5 s; cell 0.0125 m (quick: 0.025 m)",
    norm="relative difference of centre of mass, runout of 98 % of the mass and height",
    mistake="floor friction 0.5 instead of 0.7",
    measure=measure,
    control=control,
)
