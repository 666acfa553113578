"""A flat silo that empties through a slot: the deck, and what has left over time."""

from pathlib import Path

import numpy as np

from grainlaw.materials.errors import SimulationError
from grainlaw.validation.dem.cell import Reduced, write_table
from grainlaw.validation.dem.description import SlotHopper
from grainlaw.validation.dem.liggghts import data_file, decks, flow_values, output_steps, template_texts
from grainlaw.validation.dem.packing import loose, mean_volume, random_radii

Files = dict[str, str]
TABLE = "hopper.csv"
COLUMNS = ("t", "mass_inside", "opening_solid_fraction", "opening_speed")
LOOSE_FRACTION = 0.3
# Dense enough for any settled packing, and a part of the height to cut off.
FILL = 0.64 * 1.05
# Time [s] for which the grains settle after the highest one has reached the floor.
SETTLING_TIME = 0.4
# Room below the floor, in which grains fall before they leave, and beyond the walls [m].
BELOW, BESIDE = 0.15, 0.05


def files(case: SlotHopper, seed: int) -> Files:
    """Deck, data and surfaces of the run."""
    random = np.random.default_rng(seed)
    base, half = case.width * case.depth, 0.5 * case.width
    number = round(FILL * base * case.filling / mean_volume(case.grains))
    top = number * mean_volume(case.grains) / base / LOOSE_FRACTION
    space = np.array([[-half, half], [0.0, case.depth], [0.0, top]])
    falling = loose(random_radii(case.grains, number, random), space, (False, True, False), random)
    box = np.array([[-half - BESIDE, half + BESIDE], [0.0, case.depth], [-BELOW, top + BESIDE]])
    fall = np.sqrt(2.0 * top / case.gravity)
    edge = 0.5 * case.opening
    deck = decks().get_template("hopper.in.j2")
    return {
        "grains.data": data_file(falling, None, case.grains.density, box),
        "plates.stl": _plates(((-half, -edge), (edge, half)), case.depth),
        "gate.stl": _plates(((-edge, edge),), case.depth),
        "deck.in": deck.render(
            **flow_values(case, seed, fall + SETTLING_TIME),
            half_layer=0.5 * case.grains.mean_diameter,
            outputs=round(case.end / case.output_interval),
        ),
    }


def templates(code: str) -> Files:
    """The texts of the templates that a run is made from."""
    return template_texts("contact_law.in.j2", "hopper.in.j2")


def reduce(case: SlotHopper, folder: Path) -> Reduced:
    """Write the mass above the floor per depth [kg/m], and how densely and fast the opening is passed, over time."""
    above = np.loadtxt(folder / "above.txt", comments="#", ndmin=2)
    within = np.loadtxt(folder / "opening.txt", comments="#", ndmin=2)
    steps = round(case.end / case.output_interval) * output_steps(case)
    if not len(above) or above[-1, 0] < steps or len(within) != len(above) - 1:
        raise SimulationError(f"LIGGGHTS stopped before the end; see {folder / 'log.txt'}")
    layer = case.opening * case.depth * case.grains.mean_diameter * case.grains.density
    passed = np.vstack([[0.0, 0.0, 0.0], within])
    rows = []
    for (step, mass, _), (_, inside, momentum) in zip(above, passed, strict=True):
        speed = momentum / inside if inside > 0.0 else 0.0
        values = (step * case.time_step, mass / case.depth, inside / layer, speed)
        rows.append([f"{value:.6g}" for value in values])
    write_table(folder / TABLE, COLUMNS, rows)
    return Reduced(steps, round(above[0, 2]), TABLE)


def _plates(pieces: tuple[tuple[float, float], ...], depth: float) -> str:
    """Level rectangles at z = 0 over ranges of x [m] as two triangles each, in the text form of STL."""
    lines = ["solid floor"]
    for low, high in pieces:
        corners = [(low, 0.0), (high, 0.0), (high, depth), (low, depth)]
        for triangle in ((0, 1, 2), (0, 2, 3)):
            lines += ["facet normal 0 0 1", "outer loop"]
            lines += [f"vertex {corners[corner][0]:.9g} {corners[corner][1]:.9g} 0" for corner in triangle]
            lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid floor"]) + "\n"
