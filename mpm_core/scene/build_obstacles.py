"""Building the obstacles of a scene, and what is wrong with where they are."""

from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.obstacles.contact import distances
from grainlaw.mpm_core.obstacles.motion import Along, Free, Motion, Steady, at_rest, in_3d, turn_about
from grainlaw.mpm_core.obstacles.obstacle import Obstacle
from grainlaw.mpm_core.scene.initial_state import spacing_of_points
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.scene.obstacle import FreeSection, MotionSection, ObstacleSection
from grainlaw.mpm_core.scene.obstacle_surfaces import Placed, placed
from grainlaw.mpm_core.thin_plates import ThinPlates

Floats = NDArray[np.float64]

# By how much of its size a point may lie in an obstacle at the start: corners of a lattice at an oblique surface.
DEEPEST_START = 0.5


def build_obstacles(scene: Scene) -> list[Obstacle]:
    """The obstacles of a scene. Raises InputError for one that lies outside the domain, or has no surface."""
    obstacles = []
    for number, section in enumerate(scene.obstacle):
        try:
            found = placed(section.shape, scene.grid)
        except ValueError as error:
            raise InputError(f"obstacle.{number}.shape: {error}") from error
        obstacle = Obstacle(
            section.name,
            found.surface,
            section.friction,
            _motion(scene, section, found),
            section.hollow,
            np.inf if section.until is None else section.until,
        )
        _refuse_outside(scene, number, obstacle)
        obstacles.append(obstacle)
    return obstacles


def _motion(scene: Scene, section: ObstacleSection, found: Placed) -> Motion:
    pose = at_rest(found.position, found.rotation)
    if section.motion is not None:
        return _along(section.motion, found)
    if section.free is not None:
        return _free(scene, section.free, found)
    velocity, center = in_3d(section.velocity), found.position
    if section.center is not None:
        center = in_3d(section.center)
    steady = Steady(pose, velocity, _spin(section.angular_velocity), center)
    # Its velocity bounds the first step, too.
    steady.before(0.0, 0.0)
    return steady


def _along(table: MotionSection, found: Placed) -> Motion:
    ways = np.array([in_3d(way) for way in table.displacement or ()])
    angles = np.array(table.angle or [0.0] * len(ways))
    start = scipy.spatial.transform.Rotation.from_matrix(found.rotation)
    turns = turn_about(np.outer(angles, [0.0, 0.0, 1.0])) * start
    times = np.array(table.time or ())
    along = Along(times, found.position + ways, turns)
    along.before(0.0, float(times[1]))
    return along


def _free(scene: Scene, section: FreeSection, found: Placed) -> Motion:
    space = scene.in_space
    pose = at_rest(found.position, found.rotation)
    pose.velocity, pose.spin = in_3d(section.velocity), _spin(section.angular_velocity)
    # An obstacle beyond the axis sweeps nothing; that it lies outside the domain is said after this.
    volume = found.volume_per_radian if space.hoop else found.volume
    density = section.density or (section.mass or 0.0) / found.volume
    mass = section.mass or density * volume
    is_free = np.zeros(6, np.bool_)
    is_free[: space.axes] = True
    is_free[0] = not space.hoop
    if section.turns and not space.hoop:
        is_free[3:] = True if space.axes == 3 else [False, False, True]
    return Free(pose, mass, density * found.inertia, in_3d(scene.gravity), is_free)


def _spin(given: float | tuple[float, ...]) -> Floats:
    return np.array(given if isinstance(given, tuple) else (0.0, 0.0, given), np.float64)


def _refuse_outside(scene: Scene, number: int, obstacle: Obstacle) -> None:
    lower, upper = np.array(scene.grid.lower), np.array(scene.grid.upper)
    position, radius = obstacle.motion.pose.position[: len(lower)], obstacle.surface.radius
    if ((position + radius < lower) | (position - radius > upper)).any():
        raise InputError(
            f"obstacle.{number} ('{obstacle.name}') lies outside the domain {list(scene.grid.lower)} to "
            f"{list(scene.grid.upper)}"
        )


def check_start(scene: Scene, obstacles: Sequence[Obstacle], bodies: Sequence[Body]) -> None:
    """Raises InputError for a body in an obstacle, and for bodies on both sides of one too thin to part them."""
    for obstacle in obstacles:
        for section, body in zip(scene.body, bodies, strict=True):
            spacing = spacing_of_points(scene, section.points_per_cell)
            depth = -distances(obstacle, body.positions)
            inside = depth > DEEPEST_START * spacing
            if inside.any():
                place = ", ".join(f"{coordinate:g}" for coordinate in body.positions[:, np.argmax(depth)])
                raise InputError(
                    f"{body.name}: {inside.sum()} of {body.count} points lie inside obstacle '{obstacle.name}', "
                    f"the deepest at ({place})"
                )
    plates = ThinPlates(obstacles, scene.grid.cell_size)
    for obstacle in plates.parting(bodies):
        raise InputError(
            f"obstacle.{obstacles.index(obstacle)}: {plates.described(obstacle)}: bodies on its two sides would share "
            f"nodes and drag one another along; allowed: {plates.what_would_do(obstacle)}"
        )
