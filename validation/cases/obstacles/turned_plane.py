"""A block on a plane that is no axis of the grid: it slides, sticks and presses as Coulomb has it, at any angle."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.kernels.held_nodes import nodes_where
from grainlaw.mpm_core.obstacles.contact import distances
from grainlaw.mpm_core.obstacles.free_room import FreeRoom
from grainlaw.mpm_core.obstacles.obstacles import Obstacles
from grainlaw.mpm_core.scene.build_obstacles import build_obstacles
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, scaled_error, upper_bound

Floats = NDArray[np.float64]

SLIDE_BAND, DRIFT_BAND, STAND_OFF_BAND, FORCE_BAND = 3e-3, 1.5e-3, 0.05, 0.015
GRAVITY, DENSITY, LENGTH, HEIGHT, CELL = 9.81, 1500.0, 0.4, 0.2, 0.025
SLIDING, STICKING = (0.3, 30.0), (0.6, 25.0)  # friction of the plane, its slope [degrees]
END = 0.5
FOOT = (1.2, 1.0)
ANGLES, SHIFTS, CELLS = (0.0, 13.0, 27.0, 38.0, 45.0), ((0.0, 0.0), (0.3, 0.6), (0.7, 0.2)), (CELL, 0.5 * CELL)


@dataclass(frozen=True)
class OnPlane:
    """What a block did: its way along the plane over the exact one, gap below it in cells, force over its weight."""

    way: float
    exact: float
    stand_off: float
    force: float


def exact_distance(friction: float, slope: float) -> float:
    """Of a rigid block from rest [m]; zero where friction holds it."""
    turn = math.radians(slope)
    return max(0.0, 0.5 * GRAVITY * (math.sin(turn) - friction * math.cos(turn)) * END**2)


def slope_scene(cell: float, angle: float, slope: float) -> dict[str, Any]:
    """An elastic block in the middle of a box, with gravity at an angle to the normal of a plane that is turned."""
    turn = math.radians(angle + slope)
    return {
        "gravity": [GRAVITY * math.sin(turn), -GRAVITY * math.cos(turn)],
        "grid": {"cell_size": cell, "upper": [3.0, 3.0]},
        "time": {"end": END},
        "material": {"linear_elastic": {"bulk_modulus": 1e6, "poisson_ratio": 0.2}},
        "body": [
            {
                "material": "linear_elastic",
                "density": DENSITY,
                "shape": {"kind": "rectangle", "lower": [1.0, 1.0], "upper": [1.0 + LENGTH, 1.0 + HEIGHT]},
            }
        ],
    }


def turn_onto_plane(simulation: Simulation, axes: Floats, foot: Floats, friction: float, slope: float) -> None:
    """Turn the block about the middle of its lower edge, with the stress of steady sliding, or of rest."""
    (body,) = simulation.bodies
    in_plane = body.positions - np.array([[1.0 + 0.5 * LENGTH], [1.0]])
    pressure = DENSITY * GRAVITY * math.cos(math.radians(slope)) * (HEIGHT - in_plane[1])
    shear = min(friction, math.tan(math.radians(slope))) * pressure
    stress = np.einsum("ij,jkp,lk->ilp", axes, np.array([[-0.25 * pressure, shear], [shear, -pressure]]), axes)
    body.positions = foot[:, np.newaxis] + axes @ in_plane
    body.stress = np.array([stress[0, 0], stress[1, 1], -0.25 * pressure, stress[0, 1]])


def block_on_plane(
    setting: tuple[float, float], angle: float, shift: tuple[float, float], cell: float, rough: float = 1.0
) -> OnPlane:
    """Slide or hold a block; the friction of the plane is `rough` times that of the setting."""
    friction, slope = setting
    content = slope_scene(cell, angle, slope)
    simulation = Simulation(Scene.from_dict(content))
    turn = math.radians(angle)
    axes = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    foot = np.array(FOOT) + cell * np.array(shift)
    turn_onto_plane(simulation, axes, foot, friction, slope)
    plane = {"kind": "plane", "point": foot.tolist(), "normal": axes[:, 1].tolist()}
    content["obstacle"] = [{"name": "plane", "friction": rough * friction, "shape": plane}]
    # after the block has been turned: as the scene has it, it would lie in the plane
    obstacles = build_obstacles(Scene.from_dict(content))
    simulation.obstacles = Obstacles(obstacles, FreeRoom(simulation.grid, ()))
    simulation.measure_signals()
    (body,), (obstacle,) = simulation.bodies, obstacles
    start = body.positions.mean(axis=1)
    simulation.advance_to(END)
    way = axes.T @ (body.positions.mean(axis=1) - start)
    force, _ = obstacle.forces.means()
    gap = float(distances(obstacle, body.positions).min()) / cell - 0.25
    weight = float(body.masses.sum()) * GRAVITY * math.cos(math.radians(slope))
    return OnPlane(float(way[0]), exact_distance(friction, slope), gap, float(-force[:2] @ axes[:, 1]) / weight)


def held_block() -> OnPlane:
    """The mistake: no obstacle, but nodes behind the plane that are held."""
    friction, slope = SLIDING
    angle = 27.0
    simulation = Simulation(Scene.from_dict(slope_scene(CELL, angle, slope)))
    turn = math.radians(angle)
    axes = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    turn_onto_plane(simulation, axes, np.array(FOOT), friction, slope)

    def is_behind(x: Floats, y: Floats) -> NDArray[np.bool_]:
        return np.asarray((x - FOOT[0]) * axes[0, 1] + (y - FOOT[1]) * axes[1, 1] < 0.0)

    simulation.held_nodes = nodes_where(simulation.grid, is_behind)
    simulation.measure_signals()
    (body,) = simulation.bodies
    start = body.positions.mean(axis=1)
    simulation.advance_to(END)
    way = axes.T @ (body.positions.mean(axis=1) - start)
    return OnPlane(float(way[0]), exact_distance(friction, slope), 0.0, 1.0)


def slide_error(label: str, found: OnPlane) -> Measurement:
    """The distance slid against the exact one."""
    return scaled_error(f"distance slid{label}", "m", found.way, found.exact, found.exact, SLIDE_BAND)


def worst(label: str, found: list[OnPlane]) -> tuple[Measurement, ...]:
    """The worst of several blocks that slide."""
    slide = max(found, key=lambda one: abs(one.way - one.exact))
    apart = max(found, key=lambda one: abs(one.stand_off))
    force = max(found, key=lambda one: abs(one.force - 1.0))
    return (
        slide_error(label, slide),
        upper_bound(f"stand-off{label}", "cells", apart.stand_off, STAND_OFF_BAND),
        scaled_error(f"mean force over weight{label}", "1", force.force, 1.0, 1.0, FORCE_BAND),
    )


def measure(effort: Effort) -> Evidence:
    """One angle; in full five angles, three places on the grid and two cells, of which the worst counts."""
    full = effort is Effort.FULL
    angles, shifts, cells = (ANGLES, SHIFTS, CELLS) if full else ((27.0,), SHIFTS[1:2], CELLS[:1])
    settings = [(angle, shift, cell) for angle in angles for shift in shifts for cell in cells]
    slid = [block_on_plane(SLIDING, *setting) for setting in settings]
    label = f", the worst of {len(settings)}" if full else ", 27 degrees"
    held = [block_on_plane(STICKING, angle, shifts[0], CELL) for angle in angles]
    drift = max(abs(one.way) for one in held) / HEIGHT
    return Evidence((*worst(label, slid), upper_bound(f"drift of a held block{label}", "1", drift, DRIFT_BAND)))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A plane that is a fifth too rough, and nodes held in place of an obstacle."""
    rough = block_on_plane(SLIDING, 27.0, SHIFTS[1], CELL, rough=1.2)
    return slide_error(", friction 20 % too large", rough), slide_error(", nodes held", held_block())


CASE = Case(
    name="turned_plane",
    title="block on an obstacle's plane at any angle to the grid",
    proves="an obstacle takes Coulomb's share of the normal force, holds what friction holds, and touches where it is",
    reference="x = g (sin theta - mu cos theta) t^2/2; rest; the weight's normal part",
    norm="relative error of the distance and of the mean force; drift over the height; gap in cells",
    mistake="friction 20 % too large; and the nodes behind the plane held",
    measure=measure,
    control=control,
)
