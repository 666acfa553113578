"""What is measured of a run: runout, height, centre of mass."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.cell_volumes import cell_volumes
from grainlaw.mpm_core.output.middle import Middle, middle_of
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation

# The middle share of the mass between the fronts: single points that roll ahead do not count.
MASS_BETWEEN_FRONTS = 0.98


@dataclass(frozen=True)
class Measure:
    """What shapes are measured with.

    floor            level of the floor of the domain [m]
    cell_size        edge of a cell [m]
    points_per_cell  of the bodies in the mean, for axisymmetry
    middle           of the bodies at the start, in 3D
    """

    floor: float
    cell_size: float
    points_per_cell: float = 1.0
    middle: Middle | None = None


@dataclass(frozen=True)
class PileShape:
    """Extent of the material [m].

    front_left, front_right   x beyond which lies 1 % of the mass
    runout                    half of the distance between the fronts; in axisymmetry the radius, and in 3D the
                              horizontal distance from the middle, beyond which lies 2 % of the mass
    height                    the level above which lies one cell's worth of material, above the floor of the domain;
                              in axisymmetry, where points have masses as their radii, of as many points
    center_of_mass_height     of all points, above the floor of the domain

    Of what has left entirely runout and height are 0, fronts and centre of mass NaN.
    """

    runout: float
    front_left: float
    front_right: float
    height: float
    center_of_mass_height: float


@dataclass(frozen=True)
class InteriorOverfill:
    """The volume that points bring to the cells inside the material over their room, less one: mean and scatter [1]."""

    mean: float
    scatter: float


def interior_overfill(simulation: Simulation) -> InteriorOverfill:
    """Measure it over cells of loose material that are far enough from any free surface; zero where there is none."""
    room_of = simulation.obstacles.room_of
    volumes = cell_volumes(simulation.bodies, simulation.grid, simulation.periodic_axes, room_of=room_of)
    inside = volumes.overfill[volumes.is_interior() & ~volumes.is_held]
    return InteriorOverfill(float(inside.mean()), float(inside.std())) if inside.size else InteriorOverfill(0.0, 0.0)


def measure_of(scene: Scene) -> Measure:
    """With what the shapes of a scene's bodies are measured."""
    points_per_cell = float(np.mean([section.points_per_cell for section in scene.with_points]))
    return Measure(scene.grid.lower[scene.in_space.up], scene.grid.cell_size, points_per_cell, middle_of(scene))


def shape_of(simulation: Simulation) -> PileShape:
    """The present shape of all bodies together."""
    return pile_shape(simulation.bodies, measure_of(simulation.scene))


def pile_shape(bodies: Sequence[Body], measure: Measure) -> PileShape:
    """Measure the shape of all bodies together. Where all material has left, nothing has no extent and no place."""
    space = bodies[0].space
    positions = np.concatenate([body.positions for body in bodies], axis=1)
    x, up = positions[0], positions[space.up]
    mass = np.concatenate([body.masses for body in bodies])
    if len(mass) == 0:
        return PileShape(runout=0.0, front_left=nan, front_right=nan, height=0.0, center_of_mass_height=nan)
    beyond = 0.5 * (1.0 - MASS_BETWEEN_FRONTS) * mass.sum()
    front_left = _level(x, mass, beyond)
    front_right = -_level(-x, mass, beyond)
    runout = 0.5 * (front_right - front_left)
    if space.hoop or measure.middle is not None:
        away = x if measure.middle is None else measure.middle.distance(positions)
        runout = -_level(-away, mass, 2.0 * beyond)
    if space.hoop:
        top = -_level(-up, np.ones_like(mass), measure.points_per_cell)
    else:
        top = -_level(-up, mass, mass.sum() / len(mass) * _points_per_cell(bodies, measure.cell_size))
    return PileShape(
        runout=runout,
        front_left=front_left,
        front_right=front_right,
        height=top - measure.floor,
        center_of_mass_height=float(np.average(up, weights=mass)) - measure.floor,
    )


def _level(coordinate: NDArray[np.float64], mass: NDArray[np.float64], share: float) -> float:
    """The coordinate below which lies `share` of the mass [as the mass]."""
    count = min(len(mass), int(np.ceil(2.0 * share / mass.min())))
    lowest = np.argpartition(coordinate, count - 1)[:count]
    order = lowest[np.argsort(coordinate[lowest])]
    # A share that is a whole number of points must not take one more by rounding.
    position = int(np.searchsorted(np.cumsum(mass[order]), share * (1.0 - 1e-9)))
    return float(coordinate[order[min(position, count - 1)]])


def _points_per_cell(bodies: Sequence[Body], cell_size: float) -> float:
    """Points in a full cell, from the sizes of points at the start."""
    volume = float(np.mean([body.masses.mean() / body.initial_density for body in bodies if body.count > 0]))
    return cell_size ** bodies[0].space.axes / volume
