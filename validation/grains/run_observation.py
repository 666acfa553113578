"""A run's folder of this library observed as grains are."""

from pathlib import Path

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.output.run_folder import SCENE_NAME, RunFolder
from grainlaw.mpm_core.scene.initial_state import build_bodies
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.validation.grains.material_points import DEPTH, grain_density, grain_diameter, mirrored, snapshots_of_run
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.observe import Setting, observe


def observe_run(folder: Path, width: float, density: float | None = None) -> Observation:
    """The observation of a run with a kernel of the grains' width [m].

    `density` is that of the grains [kg/m3], for a law that declares none.
    A column that stands against a free-slip side is taken for the half of one that is symmetric about it.
    Raises InputError if the folder holds no run, or frames without velocity.
    """
    run = RunFolder(folder)
    scene = Scene.load(folder / SCENE_NAME)
    bodies = build_bodies(scene)
    lowest = min(float(body.positions[0].min()) for body in bodies)
    highest = max(float(body.positions[0].max()) for body in bodies)
    found = grain_density(bodies, density)
    snapshots = snapshots_of_run(run, scene, found)
    center = 0.5 * (lowest + highest)
    left = scene.grid.lower[0]
    if scene.boundary.left.kind == "free_slip" and lowest - left < scene.grid.cell_size:
        center = left
        snapshots = (mirrored(snapshot, left) for snapshot in snapshots)
    setting = Setting(
        width=width,
        depth=DEPTH,
        floor=scene.grid.lower[1],
        center=center,
        grain_density=found,
        gravity=-scene.gravity[1],
    )
    return observe(snapshots, setting, _description(folder, scene, bodies))


def diameter_of_run(folder: Path) -> float | None:
    """The grain diameter that the laws of a run declare [m], if it is one. Raises InputError if there is no run."""
    RunFolder(folder)
    return grain_diameter(build_bodies(Scene.load(folder / SCENE_NAME)))


def _description(folder: Path, scene: Scene, bodies: list[Body]) -> dict[str, object]:
    laws = ", ".join(dict.fromkeys(body.law.name for body in bodies))
    return {"label": folder.name, "laws": laws, "points": sum(body.count for body in bodies), "title": scene.title}
