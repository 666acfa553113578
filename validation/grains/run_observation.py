"""A run's folder of this library observed as grains are.

A run in 3D is compared with what it stands for: a plane column, over the depth of its domain, or a cylinder, all around
its axis.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.output.run_folder import SCENE_NAME, RunFolder
from grainlaw.mpm_core.scene.initial_state import build_bodies
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.space import PLANE_STRAIN, Space
from grainlaw.validation.grains.material_points import (
    DEPTH,
    filled_space,
    grain_density,
    grain_diameter,
    mirrored,
    snapshots_of_run,
)
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.observe import Setting, observe
from grainlaw.validation.grains.snapshot import Array, GrainSnapshot


def observe_run(folder: Path, width: float, density: float | None = None, space: Space = PLANE_STRAIN) -> Observation:
    """The observation of a run with a kernel of the grains' width [m].

    `density` is that of the grains [kg/m3], for a law that declares none. `space` is that of what a run in 3D is
    compared with: plane strain for a plane column, axisymmetry for a cylinder.
    A column that stands against a free-slip side is taken for the half, or the quarter, of one that is symmetric about
    it. Raises InputError if the folder holds no run, or frames without velocity.
    """
    run = RunFolder(folder)
    scene = Scene.load(folder / SCENE_NAME)
    bodies = build_bodies(scene)
    found = grain_density(bodies, density)
    setting, snapshots = as_grains(scene, bodies, snapshots_of_run(run, scene, found), width, found, space)
    return observe(snapshots, setting, _description(folder, scene, bodies))


def as_grains(
    scene: Scene,
    bodies: Sequence[Body],
    snapshots: Iterable[GrainSnapshot],
    width: float,
    density: float,
    space: Space = PLANE_STRAIN,
) -> tuple[Setting, Iterable[GrainSnapshot]]:
    """How the points of a scene are observed, and the whole body where the scene holds half or a quarter of it.

    `bodies` as they were at the start; the others as for `observe_run`.
    """
    up = scene.in_space.up
    setting = Setting(
        width=width,
        depth=DEPTH,
        floor=scene.grid.lower[up],
        center=0.0,
        grain_density=density,
        gravity=-scene.gravity[up],
        space=space if scene.in_space.axes == 3 else scene.in_space,
    )
    if scene.in_space.hoop:
        return setting, snapshots
    lowest = np.min([body.positions.min(axis=1) for body in bodies], axis=0)
    highest = np.max([body.positions.max(axis=1) for body in bodies], axis=0)
    place = _around_axis if setting.space.hoop else _along_slope
    return place(scene, setting, snapshots, lowest, highest)


def start_of_run(folder: Path, space: Space = PLANE_STRAIN) -> tuple[float, float]:
    """The volume that the bodies of a run fill at the start [m3], and the distance of its points [m].

    Per metre of depth in plane strain; halves and quarters count as wholes. `space` as for `observe_run`.
    """
    RunFolder(folder)
    scene = Scene.load(folder / SCENE_NAME)
    return filled_volume(scene, build_bodies(scene), space), spacing_of_points(scene)


def filled_volume(scene: Scene, bodies: Sequence[Body], space: Space = PLANE_STRAIN) -> float:
    """The volume of `start_of_run`, from the bodies as they are at the start."""
    setting, snapshots = as_grains(scene, bodies, [filled_space(bodies)], 1.0, 1.0, space)
    return sum(float(snapshot.solid_volumes.sum()) for snapshot in snapshots) / setting.depth


def spacing_of_points(scene: Scene) -> float:
    """The distance of the points at the start [m], the largest of all bodies."""
    fewest = min(body.points_per_cell for body in scene.body)
    return float(scene.grid.cell_size / fewest ** (1.0 / scene.in_space.axes))


def mean_density(folder: Path) -> float:
    """Bulk density of all bodies at the start [kg/m3]."""
    bodies = build_bodies(Scene.load(folder / SCENE_NAME))
    return float(sum(body.masses.sum() for body in bodies) / sum(body.volume.sum() for body in bodies))


def _is_halved(scene: Scene, axis: int, lowest: Array) -> bool:
    """Whether the bodies stand against a plane of symmetry at the lower side along an axis."""
    side = scene.boundary.of(scene.in_space.sides[axis][0])
    return bool(side.kind == "free_slip" and lowest[axis] - scene.grid.lower[axis] < scene.grid.cell_size)


def _along_slope(
    scene: Scene, setting: Setting, snapshots: Iterable[GrainSnapshot], lowest: Array, highest: Array
) -> tuple[Setting, Iterable[GrainSnapshot]]:
    """A plane column, over the depth of a domain in 3D, mirrored where it is half of one."""
    if scene.in_space.axes == 3:
        setting = replace(setting, depth=scene.grid.upper[1] - scene.grid.lower[1])
    if _is_halved(scene, 0, lowest):
        left = scene.grid.lower[0]
        return replace(setting, center=left), (mirrored(snapshot, left) for snapshot in snapshots)
    return replace(setting, center=0.5 * float(lowest[0] + highest[0])), snapshots


def _around_axis(
    scene: Scene, setting: Setting, snapshots: Iterable[GrainSnapshot], lowest: Array, highest: Array
) -> tuple[Setting, Iterable[GrainSnapshot]]:
    """A cylinder in 3D, or the half or the quarter of one, whose points count for the others."""
    halved = [_is_halved(scene, axis, lowest) for axis in (0, 1)]
    x, y = (scene.grid.lower[axis] if halved[axis] else 0.5 * float(lowest[axis] + highest[axis]) for axis in (0, 1))
    times = 2.0 ** sum(halved)
    whole = (replace(snapshot, solid_volumes=times * snapshot.solid_volumes) for snapshot in snapshots)
    return replace(setting, center=x, center_y=y), whole


def diameter_of_run(folder: Path) -> float | None:
    """The grain diameter that the laws of a run declare [m], if it is one. Raises InputError if there is no run."""
    RunFolder(folder)
    return grain_diameter(build_bodies(Scene.load(folder / SCENE_NAME)))


def _description(folder: Path, scene: Scene, bodies: list[Body]) -> dict[str, object]:
    laws = ", ".join(dict.fromkeys(body.law.name for body in bodies))
    return {"label": folder.name, "laws": laws, "points": sum(body.count for body in bodies), "title": scene.title}
