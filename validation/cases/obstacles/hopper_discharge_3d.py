"""A conical hopper, a closed surface of triangles, empties through round openings at a rate that grows as D^(5/2)."""

import math
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.scenes import advance, shipped_simulation

EXPONENT, BAND = 2.5, 0.05
OPENINGS = {Effort.QUICK: (0.1, 0.15), Effort.FULL: (0.1, 0.125, 0.15)}
CELLS_ACROSS = 8
# The silo above the cone, and the wall of both, thicker than three cells [m].
RADIUS, FILLED, WALL, SLOPE = 0.15, 0.15, 0.06, math.radians(60.0)
PARTS_AROUND = 64
FROM, UNTIL = 0.2, 0.5  # when the flow is steady, and the hopper not yet empty [s]


def cone_height(opening: float) -> float:
    """Of the cone above an opening [m]."""
    return (RADIUS - 0.5 * opening) * math.tan(SLOPE)


def hopper_surface(opening: float) -> Any:
    """The closed surface of the walls, a body of revolution about z whose opening [m] lies at z = 0."""
    from trimesh.creation import revolve

    inner, top = 0.5 * opening, cone_height(opening)
    end = top + FILLED + 0.1
    profile = [
        (inner, 0.0),
        (inner + WALL, 0.0),
        (RADIUS + WALL, top),
        (RADIUS + WALL, end),
        (RADIUS, end),
        (RADIUS, top),
        (inner, 0.0),
    ]
    return revolve(np.array(profile), sections=PARTS_AROUND)


def discharged(opening: float, cells_across: int, folder: Path) -> tuple[list[float], list[float]]:
    """Times [s], and the mass that has passed the opening, of a quarter [kg]."""
    file, cell, top = folder / f"{opening:g}.stl", opening / cells_across, cone_height(opening)
    hopper_surface(opening).export(file)
    wide, high = (math.ceil(length / cell - 1e-9) * cell for length in (RADIUS + 2.0 * cell, top + FILLED + cell))
    axis = {"center": [0.0, 0.0, 0.0], "kind": "cone", "radius": 0.5 * opening, "upper_radius": RADIUS, "height": top}
    cylinder = {"kind": "cylinder", "center": [0.0, 0.0, top], "radius": RADIUS, "height": FILLED}
    changes = {
        "grid.cell_size": cell,
        "grid.lower": [0.0, 0.0, -4.0 * cell],
        "grid.upper": [wide, wide, high],
        "body.0.shape": axis,
        "body.1.shape": cylinder,
        "obstacle.0.shape.file": str(file),
    }
    times, masses = [], []

    def observe(present: Simulation) -> None:
        below = sum(float(body.masses[body.positions[2] < 0.0].sum()) for body in present.bodies)
        times.append(present.time)
        masses.append(present.ledger.mass_left + below)

    advance(shipped_simulation("hopper_3d", changes), UNTIL, observe, intervals=25)
    return times, masses


def rate(found: tuple[list[float], list[float]]) -> float:
    """The rate of discharge while it is steady [kg/s]."""
    times, masses = map(np.array, found)
    steady = times >= FROM
    return float(np.polyfit(times[steady], masses[steady], 1)[0])


def exponent(rates: dict[float, float]) -> float:
    """Of the rate over the opening."""
    openings, values = zip(*rates.items(), strict=True)
    return float(np.polyfit(np.log(openings), np.log(values), 1)[0])


def measure(effort: Effort) -> Evidence:
    """Two openings, in full three, all of as many cells."""
    with TemporaryDirectory() as folder:
        runs = {opening: discharged(opening, CELLS_ACROSS, Path(folder)) for opening in OPENINGS[effort]}
    found = exponent({opening: rate(run) for opening, run in runs.items()})
    curves = tuple(curve(f"D = {opening:g} m", *run) for opening, run in runs.items())
    figure = Figure("Mass discharged through a quarter", "time [s]", "mass [kg]", curves)
    return Evidence((relative_error("exponent of D", "1", found, EXPONENT, BAND),), figures=(figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The smaller opening with half of the cells across of the larger: the grid narrows it."""
    small, large = OPENINGS[Effort.QUICK]
    with TemporaryDirectory() as folder:
        rates = {
            opening: rate(discharged(opening, cells, Path(folder)))
            for opening, cells in ((small, CELLS_ACROSS // 2), (large, CELLS_ACROSS))
        }
    return (relative_error("exponent of D", "1", exponent(rates), EXPONENT, BAND),)


CASE = Case(
    name="hopper_discharge_3d",
    title="discharge of a conical hopper in 3D, given by triangles, through round openings",
    proves="sand flows through a hopper that is a mesh by the width of its opening",
    reference="Q grows as D^(5/2) (Beverloo, Leniger & van de Velde 1961)",
    norm="relative error of the exponent fitted to the rates through the openings",
    mistake="one opening of four cells, the other of eight",
    measure=measure,
    control=control,
)
