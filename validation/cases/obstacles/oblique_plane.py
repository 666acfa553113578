"""A block slides down a plane in 3D that is oblique to all axes of the grid, in a direction that is oblique on it."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from grainlaw.mpm_core.obstacles.free_room import FreeRoom
from grainlaw.mpm_core.obstacles.obstacles import Obstacles
from grainlaw.mpm_core.scene.build_obstacles import build_obstacles
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, scaled_error

Floats = NDArray[np.float64]

BAND, FORCE_BAND = 3e-3, 0.015
GRAVITY, DENSITY, HEIGHT, CELL, END = 9.81, 1500.0, 0.2, 0.05, 0.3
FRICTION, SLOPE, COURSE = 0.3, math.radians(30.0), 0.4
FOOT = (0.9, 0.9, 0.9)
# Rotation vectors from the horizontal plane.
TURNS = ((0.3, 0.5, 0.2), (0.6, -0.4, 0.7), (0.0, 0.0, 0.0))


@dataclass(frozen=True)
class Slide:
    """The way along the steepest descent and across it, over the exact one; the mean force over the weight."""

    along: float
    across: float
    force: float


def block(axes: Floats, downhill: Floats) -> Simulation:
    """A block in its place on the plane, with the stress of steady sliding and no plane yet."""
    gravity = GRAVITY * (math.sin(SLOPE) * downhill - math.cos(SLOPE) * axes[:, 2])
    simulation = Simulation(Scene.from_dict(_content(gravity)))
    (body,) = simulation.bodies
    in_plane = body.positions - np.array([[1.0], [1.0], [1.0]])
    pressure = DENSITY * GRAVITY * math.cos(SLOPE) * (HEIGHT - in_plane[2])
    course = axes.T @ downhill
    stress = np.zeros((3, 3, body.count))
    stress[0, 0] = stress[1, 1] = -0.25 * pressure
    stress[2, 2] = -pressure
    for axis in (0, 1):
        stress[axis, 2] = stress[2, axis] = FRICTION * course[axis] * pressure
    stress = np.einsum("ij,jkp,lk->ilp", axes, stress, axes)
    body.positions = np.array(FOOT)[:, np.newaxis] + axes @ in_plane
    body.stress = stress[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
    return simulation


def _content(gravity: Floats, *obstacles: dict[str, Any]) -> dict[str, Any]:
    return {
        "space": "3d",
        "gravity": gravity.tolist(),
        "grid": {"cell_size": CELL, "upper": [2.0, 2.0, 2.0]},
        "time": {"end": END},
        "material": {"linear_elastic": {"bulk_modulus": 1e6, "poisson_ratio": 0.2}},
        "body": [
            {
                "material": "linear_elastic",
                "density": DENSITY,
                "shape": {"kind": "box", "lower": [0.8, 0.8, 1.0], "upper": [1.2, 1.2, 1.0 + HEIGHT]},
            }
        ],
        "obstacle": list(obstacles),
    }


def slide(turn: tuple[float, ...], friction: float = FRICTION) -> Slide:
    """Let the block slide on a plane turned by a vector, of some friction."""
    axes = np.asarray(Rotation.from_rotvec(turn).as_matrix())
    downhill = axes[:, :2] @ np.array([math.cos(COURSE), math.sin(COURSE)])
    simulation = block(axes, downhill)
    plane = {"kind": "plane", "point": list(FOOT), "normal": axes[:, 2].tolist()}
    content = _content(np.array(simulation.scene.gravity), {"name": "plane", "friction": friction, "shape": plane})
    obstacles = build_obstacles(Scene.from_dict(content))
    simulation.obstacles = Obstacles(obstacles, FreeRoom(simulation.grid, ()))
    simulation.measure_signals()
    (body,) = simulation.bodies
    start = body.positions.mean(axis=1)
    simulation.advance_to(END)
    way = body.positions.mean(axis=1) - start
    force, _ = obstacles[0].forces.means()
    weight = float(body.masses.sum()) * GRAVITY * math.cos(SLOPE)
    exact = 0.5 * GRAVITY * (math.sin(SLOPE) - FRICTION * math.cos(SLOPE)) * END**2
    across = np.cross(axes[:, 2], downhill)
    return Slide(float(way @ downhill) / exact, float(way @ across) / exact, float(-force @ axes[:, 2]) / weight)


def _measured(label: str, found: Slide) -> tuple[Measurement, ...]:
    return (
        scaled_error(f"distance over the exact one{label}", "1", found.along, 1.0, 1.0, BAND),
        scaled_error(f"way across over that{label}", "1", found.across, 0.0, 1.0, 2.0 * BAND),
        scaled_error(f"mean force over weight{label}", "1", found.force, 1.0, 1.0, FORCE_BAND),
    )


def measure(effort: Effort) -> Evidence:
    """One plane, in full three."""
    turns = TURNS if effort is Effort.FULL else TURNS[:1]
    found = [measured for turn in turns for measured in _measured(f", turned by {turn}", slide(turn))]
    return Evidence(tuple(found))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A plane that is a fifth too rough."""
    return _measured("", slide(TURNS[0], 1.2 * FRICTION))[:1]


CASE = Case(
    name="oblique_plane",
    title="block on an oblique plane in 3D, sliding obliquely",
    proves="in 3D an obstacle takes Coulomb's share of the normal force against the sliding, whatever way that goes",
    reference="x = g (sin theta - mu cos theta) t^2/2 along the steepest descent",
    norm="errors over the exact distance and over the weight",
    mistake="friction 20 % too large",
    measure=measure,
    control=control,
)
