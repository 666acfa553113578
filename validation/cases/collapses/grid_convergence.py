"""The final pile of the paper's collapse on finer and finer grids."""

from itertools import pairwise

from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Figure, Measurement, curve
from grainlaw.validation.cases.collapses.column import OBSERVABLES, SCENES, Pile, collapse, pile, shape_errors
from grainlaw.validation.scenes import advance

BAND = 3e-2
END = 1.5
CELLS: dict[Effort, dict[str, tuple[float, ...]]] = {
    Effort.QUICK: {"mu(I)-LC": (0.05, 0.025)},
    Effort.FULL: dict.fromkeys(SCENES, (0.025, 0.0125, 0.00625, 0.003125)),
}


def final_pile(material: str, cell_size: float) -> Pile:
    """The pile at the end on cells of this size [m]."""
    simulation = collapse(material, cell_size)
    advance(simulation, END)
    return pile(simulation)


def last_changes(material: str, piles: dict[float, Pile]) -> tuple[Measurement, ...]:
    """The finest grid against the one before."""
    *_, coarser, finest = sorted(piles, reverse=True)
    return shape_errors(piles[coarser], piles[finest], BAND, f"{material}: {{}}, cell {coarser:g} m")


def changes(material: str, piles: dict[float, Pile]) -> Convergence:
    """Change of the centre of mass from each grid to the next finer one; its fitted slope is the observed order."""
    sizes = sorted(piles, reverse=True)
    heights = [piles[size].shape.center_of_mass_height for size in sizes]
    # A change of nothing has no logarithm.
    found = [max(abs(a - b) / b, 1e-12) for a, b in pairwise(heights)]
    return Convergence(f"{material}: change of the centre of mass", "cell size [m]", tuple(sizes[:-1]), tuple(found))


def measure(effort: Effort) -> Evidence:
    """The paper's three materials; mu(I)-LC alone, and coarse, in quick."""
    results = {
        material: {size: final_pile(material, size) for size in sizes} for material, sizes in CELLS[effort].items()
    }
    found = [measurement for material, piles in results.items() for measurement in last_changes(material, piles)]
    orders = tuple(changes(material, piles) for material, piles in results.items() if len(piles) > 2)
    figures = tuple(
        Figure(
            f"Final {name.replace('_', ' ')}",
            "cell size [m]",
            "length [m]",
            tuple(
                curve(material, list(piles), [getattr(one.shape, name) for one in piles.values()])
                for material, piles in results.items()
            ),
            logarithmic="x",
        )
        for name in OBSERVABLES
    )
    notes = tuple(
        f"{material}, cell {size:g} m: centre of mass {one.shape.center_of_mass_height:.4f}, "
        f"half width {one.shape.runout:.3f}, top {one.shape.height:.3f} m"
        for material, piles in results.items()
        for size, one in piles.items()
    )
    return Evidence(tuple(found), orders, figures, notes)


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The fine one of two grids with a smoother floor."""
    simulation = collapse("mu(I)-LC", 0.025, {"boundary.bottom.coefficient": 0.4})
    advance(simulation, END)
    return last_changes("mu(I)-LC", {0.05: final_pile("mu(I)-LC", 0.05), 0.025: pile(simulation)})


CASE = Case(
    name="grid_convergence",
    title="column collapse on finer and finer grids",
    proves="the pile is a property of the law and the scene, not of the grid",
    reference="the same collapse on cells of half the size, at t = 1.5 s",
    norm="relative difference of centre of mass, runout of 98 % of the mass and height between the two finest grids",
    mistake="floor friction 0.4 instead of 0.7 on the finer grid",
    measure=measure,
    control=control,
)
