"""The column of the grains as a scene: the same mass, the same surface at the start, half of it by symmetry.

A cylinder is a scene in axisymmetry: the same rectangle, of which a radian is computed.
"""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.mpm_core.space import Space
from grainlaw.validation.grains.coarse_graining import column_weights
from grainlaw.validation.grains.material_points import DEPTH, mirrored, snapshot_of_bodies
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.observe import Setting, observe
from grainlaw.validation.grains.snapshot import GrainSnapshot
from grainlaw.validation.reference.reference_set import Ensemble, ReferenceSet
from grainlaw.validation.scenes import advance

# Of glued grains, and of the contacts of all grains.
ROUGH_FRICTION = 0.7
# The surface next to the sides is rounded by the kernel.
SIDE_IN_WIDTHS = 2.0
REACH = 1.8


@dataclass(frozen=True)
class Column:
    """What the continuum takes from the packing: half width, height [m], bulk density [kg/m3], and when to look [s].

    In axisymmetry `half_width` is the radius.
    """

    half_width: float
    height: float
    density: float
    grain_density: float
    grain_diameter: float
    gravity: float
    reach: float
    times: tuple[float, ...]
    space: Space
    floor_friction: float = ROUGH_FRICTION


def flat_friction(reference: ReferenceSet) -> float:
    """Friction of a flat plane under shear of the grains, the mean over the rates; that of the contacts if unknown."""
    rows = reference.test("wall_shear")
    return float(np.mean([row["mu"] for row in rows])) if rows else ROUGH_FRICTION


def column_of(ensemble: Ensemble, floor_friction: float = ROUGH_FRICTION) -> Column:
    """The mean column of all runs of a case; its density is that with which the mass is the same."""
    first = ensemble.runs[0].description
    diameter = float(np.mean([run.description["kernel_width"] for run in ensemble.runs]))
    heights, solids, reaches = [], [], []
    around, base = 1.0, 2.0 * ensemble.half_width
    if ensemble.space.hoop:
        around, base = 2.0 * np.pi, np.pi * ensemble.half_width**2
    for run in ensemble.runs:
        weights = column_weights(run.x, run.space)
        middle = np.abs(run.x) < ensemble.half_width - SIDE_IN_WIDTHS * diameter
        heights.append(np.average(run.surface[0][middle], weights=weights[middle]))
        solid = (weights[:, None] * run.snapshots["solid_fraction"][0]).sum() * (run.x[1] - run.x[0])
        solids.append(around * solid * (run.z[1] - run.z[0]))
        reaches.append(run.of("runout")[-1])
    height = float(np.mean(heights))
    grain_density = float(first["grain_density"])
    longest = max(ensemble.runs, key=lambda run: len(run.times))
    return Column(
        half_width=ensemble.half_width,
        height=height,
        density=grain_density * float(np.mean(solids)) / (base * height),
        grain_density=grain_density,
        grain_diameter=diameter,
        gravity=float(first["gravity"]),
        reach=REACH * float(max(reaches)),
        times=tuple(found for found in longest.times.tolist() if found <= ensemble.end + 1e-9),
        space=ensemble.space,
        floor_friction=floor_friction,
    )


def column_scene(column: Column, law: str, parameters: dict[str, float], cell_size: float) -> dict[str, Any]:
    """The scene; the height is rounded to whole points and the density changed so that the mass stays."""
    half_cell = 0.5 * cell_size
    height = round(column.height / half_cell) * half_cell
    width = round(column.half_width / half_cell) * half_cell
    density = column.density * column.height * column.half_width / (height * width)
    upper = [np.ceil(length / cell_size) * cell_size for length in (column.reach, 1.1 * height)]
    initial_stress: dict[str, Any] = {"kind": "geostatic"}
    if not column.space.hoop:
        initial_stress["out_of_plane_ratio"] = 0.5
    scene: dict[str, Any] = {
        "title": f"DEM column, {law}",
        "gravity": [0.0, -column.gravity],
        "grid": {"cell_size": cell_size, "upper": [float(length) for length in upper]},
        "boundary": {"bottom": {"kind": "friction", "coefficient": column.floor_friction}},
        "time": {"end": column.times[-1]},
        "material": {law: parameters},
        "body": [
            {
                "material": law,
                "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [width, height]},
                "density": density,
                "initial_stress": initial_stress,
            }
        ],
        "output": {"fields": []},
    }
    # The key of a run that is there already is made from its scene: plane strain goes without saying.
    return scene | {"space": column.space.name} if column.space.hoop else scene


def observed_column(content: dict[str, Any], column: Column, label: str) -> Observation:
    """Run a scene of the column and observe it at the times of the grains, through the same functions.

    Raises InputError for a scene that cannot be run and SimulationError if it breaks down.
    """
    simulation = Simulation(Scene.from_dict(content, label))

    def snapshot() -> GrainSnapshot:
        half = snapshot_of_bodies(simulation.time, simulation.bodies, column.grain_density)
        return half if column.space.hoop else mirrored(half)

    snapshots = [snapshot()]
    # The first interval compiles the kernels; its cost is taken to be that of the others.
    started, first_steps = 0.0, 0
    for target in column.times[1:]:
        advance(simulation, target)
        snapshots.append(snapshot())
        if first_steps == 0:
            started, first_steps = time.process_time(), simulation.steps
    cost = (time.process_time() - started) * simulation.steps / (simulation.steps - first_steps)
    points = sum(body.count for body in simulation.bodies)
    setting = Setting(
        width=column.grain_diameter,
        depth=DEPTH,
        floor=0.0,
        center=0.0,
        grain_density=column.grain_density,
        gravity=-simulation.scene.gravity[1],
        space=column.space,
    )
    description = {"label": label, "scene": content, "cpu_time": cost, "points": points, "steps": simulation.steps}
    return observe(snapshots, setting, description)
