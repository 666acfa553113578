"""A column collapses on an obstacle's plane at an angle to the grid, as it does on a wall of the domain."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.obstacles.free_room import FreeRoom
from grainlaw.mpm_core.obstacles.obstacles import Obstacles
from grainlaw.mpm_core.scene.build_obstacles import build_obstacles
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.cases.collapses.column import collapse

Floats = NDArray[np.float64]

# E_A by cell size [m].
BANDS = {Effort.QUICK: {0.0125: 0.03}, Effort.FULL: {0.0125: 0.03, 0.00625: 0.015}}
ANGLES = {Effort.QUICK: (27.0,), Effort.FULL: (13.0, 27.0, 38.0)}
END = 1.5
FRICTION, GRAVITY = 0.7, 9.8
# Where the middle of the column stands, upright and turned [m], and the domain of the turned one.
MIDDLE, FOOT, DOMAIN = 1.6, (1.5, 1.2), [3.0, 3.0]
# Parts of the floor over which a profile is taken [m].
PART = 0.025


@dataclass(frozen=True)
class Profile:
    """The depth of a pile over places along the floor, from its middle [m]: the volume of points over each part."""

    places: Floats
    depth: Floats


def profile(simulation: Simulation, along: Floats) -> Profile:
    """The present profile; `along` are the places of the points along the floor [m]."""
    (body,) = simulation.bodies
    edges = PART * np.arange(-50, 51)
    # each point as a triangle two parts wide
    ends = np.floor(along / PART - 0.5).astype(int)
    share = along / PART - 0.5 - ends
    depth = np.zeros(len(edges) - 1)
    for number, weight in ((ends, 1.0 - share), (ends + 1, share)):
        np.add.at(depth, np.clip(number + 50, 0, len(depth) - 1), weight * body.volume / PART)
    return Profile(0.5 * (edges[1:] + edges[:-1]), depth)


def upright(cell: float) -> Profile:
    """The pile on the domain's friction wall."""
    simulation = collapse("mu(I)-LC", cell)
    simulation.advance_to(END)
    return profile(simulation, simulation.bodies[0].positions[0] - MIDDLE)


def turned(cell: float, angle: float, friction: float = FRICTION) -> Profile:
    """The pile on an obstacle's plane at an angle [degrees], seen along it."""
    turn = math.radians(angle)
    axes = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    gravity = (-GRAVITY * axes[:, 1]).tolist()
    changes = {"grid.upper": DOMAIN, "gravity": gravity, "boundary.bottom": {"kind": "free_slip"}}
    upright_state = collapse("mu(I)-LC", cell).bodies[0]
    simulation = collapse("mu(I)-LC", cell, {**changes, "body.0.initial_stress": {"kind": "none"}})
    (body,) = simulation.bodies
    place = np.array(FOOT)[:, np.newaxis]
    xx, yy, zz, _ = upright_state.stress
    stress = np.einsum("ij,jkp,lk->ilp", axes, np.array([[xx, 0.0 * xx], [0.0 * xx, yy]]), axes)
    body.points[:] = upright_state.points
    body.positions = place + axes @ (upright_state.positions - [[MIDDLE], [0.0]])
    body.stress = np.array([stress[0, 0], stress[1, 1], zz, stress[0, 1]])
    plane = {"kind": "plane", "point": list(FOOT), "normal": axes[:, 1].tolist()}
    content = simulation.scene.model_dump(mode="json", exclude_none=True)
    content["obstacle"] = [{"name": "floor", "friction": friction, "shape": plane}]
    obstacles = build_obstacles(type(simulation.scene).from_dict(content))
    simulation.obstacles = Obstacles(obstacles, FreeRoom(simulation.grid, ()))
    simulation.measure_signals()
    simulation.advance_to(END)
    return profile(simulation, axes[:, 0] @ (body.positions - place))


def distance(found: Profile, reference: Profile) -> float:
    """E_A: the area between two profiles over the mean of the areas below them."""
    areas = found.depth.sum() + reference.depth.sum()
    return float(np.abs(found.depth - reference.depth).sum() / (0.5 * areas))


def measure(effort: Effort) -> Evidence:
    """One angle; in full three angles on two grids."""
    found, curves = [], []
    for cell, band in BANDS[effort].items():
        reference = upright(cell)
        curves.append(curve(f"wall, {1e3 * cell:g} mm", reference.places, reference.depth, "reference"))
        for angle in ANGLES[effort]:
            pile = turned(cell, angle)
            label = f"{angle:g} degrees, {1e3 * cell:g} mm"
            found.append(upper_bound(f"E_A, {label}", "1", distance(pile, reference), band))
            curves.append(curve(label, pile.places, pile.depth))
    figure = Figure("Piles on a floor", "along the floor [m]", "depth [m]", tuple(curves))
    return Evidence(tuple(found), figures=(figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A floor without friction, on coarse cells."""
    cell, band = 0.025, BANDS[Effort.QUICK][0.0125]
    return (upper_bound("E_A", "1", distance(turned(cell, 27.0, 0.0), upright(cell)), band),)


CASE = Case(
    name="turned_column",
    title="collapse of a column on an obstacle's plane at an angle to the grid",
    proves="a floor that is an obstacle, at any angle, is to a flow what a wall of the domain is",
    reference="the same collapse on the domain's friction wall",
    norm="E_A: area between the profiles along the floor over the mean area below them, at rest",
    mistake="a floor without friction",
    measure=measure,
    control=control,
)
