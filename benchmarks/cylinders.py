"""A cylinder of grains that collapses onto a rough floor, in three dimensions: the paper's materials, 86 592 points."""

from typing import Any

from benchmarks.columns import SPREADING_RATE, set_in_motion
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.scene.shipped import shipped_scenes
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.cases.collapses.column import SCENES

RADIUS, HEIGHT = 0.15, 0.3
POINTS_PER_CELL = 8


def cylinder(material: str, cell_size: float, changes: dict[str, Any]) -> Simulation:
    """The cylinder of the material of one of `SCENES`, on cells of the given size [m], with values by dotted key."""
    shape = {"kind": "cylinder", "center": [0.0, 0.0, 0.0], "radius": RADIUS, "height": HEIGHT}
    in_space = {
        "space": "3d",
        "gravity": [0.0, 0.0, -9.8],
        "grid.cell_size": cell_size,
        "grid.lower": [-0.55, -0.55, 0.0],
        "grid.upper": [0.55, 0.55, 0.35],
        "body.0.shape": shape,
        "body.0.points_per_cell": POINTS_PER_CELL,
        "body.0.initial_stress": {"kind": "geostatic"},
        "output.fields": [],
    }
    return Simulation(Scene.load(shipped_scenes()[SCENES[material]], {**in_space, **changes}))


def moving_cylinder(material: str, cell_size: float, precision: str = "double") -> Simulation:
    """The cylinder with a velocity field that stretches and lowers it without change of volume."""
    simulation = cylinder(material, cell_size, {"precision": precision})
    set_in_motion(simulation, (SPREADING_RATE, SPREADING_RATE, -2.0 * SPREADING_RATE))
    return simulation
