"""Good scenes to spoil, and how much of a run reads them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest import mock

import tomli_w
from scenes_for_tests import BLOCK, COLUMN, CUBE, MU_I_LC, RING, changed

from grainlaw.mpm_core import Scene, simulation
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.stepping import run


def set_up(path: Path) -> object:
    """All that a run does before its kernels are compiled."""
    with mock.patch.object(Body, "choose_kernels"), mock.patch.object(simulation, "elastic_energy", return_value=0.0):
        built = run.built_simulation(Scene.load(path), 1)
        run.refuse_impossible_steps(built)
        return built.next_step(built.scene.time.end)


def scene_file(content: dict[str, Any]) -> Callable[[Path], Path]:
    """A writer of the scene."""

    def write(folder: Path) -> Path:
        path = folder / "scene.toml"
        path.write_text(tomli_w.dumps(content))
        return path

    return write


MANY = changed(
    COLUMN,
    {
        "grid.cell_size": 0.05,
        "grid.lower": [0.0, 0.0],
        "boundary": {"left": "periodic", "right": "periodic", "bottom": {"kind": "friction", "coefficient": 0.5}},
        "body.0.initial_stress": {"kind": "table", "depth": [0.0, 1.0], "vertical_stress": [0.0, 1.5e4]},
        "body.0.shape": {"kind": "polygon", "vertices": [[1.4, 0.0], [1.8, 0.0], [1.6, 0.8]]},
        "transfer": {"scheme": "affine_flip", "basis": "quadratic", "time_constant": 0.01},
        "sleep": {"speed": 1e-3, "window": 0.1, "start": 0.5},
        "time": {"end": 0.3, "safety": 0.4, "smallest_step": 1e-9},
        "output": {"interval": 0.05, "pictures": False, "fields": ["velocity"]},
    },
)
TWO = changed(
    BLOCK,
    {
        "material.mu_i_lc": MU_I_LC,
        "body": [
            *BLOCK["body"],
            {
                "material": "mu_i_lc",
                "density": 1500.0,
                "velocity": [0.1, 0.0],
                "points_per_cell": 9,
                "shape": {"kind": "disc", "center": [0.85, 0.4], "radius": 0.1},
                "initial_stress": {"kind": "geostatic", "surcharge": 10.0},
            },
        ],
        "gravity": [0.0, -9.81],
    },
)

SOLIDS = changed(
    CUBE,
    {
        "gravity": [0.0, 0.0, -9.81],
        "grid.lower": [0.0, 0.0, 0.0],
        "boundary": {
            **{"front": "periodic", "back": "periodic"},
            "bottom": {"kind": "friction", "coefficient": 0.5, "velocity": [1.0, 0.0, 0.0]},
        },
        "body": [
            CUBE["body"][0] | {"initial_stress": {"kind": "geostatic", "horizontal_ratio": 0.5}},
            CUBE["body"][0]
            | {
                "shape": {
                    "kind": "cone",
                    "center": [0.5, 0.4, 0.4],
                    "radius": 0.15,
                    "height": 0.2,
                    "upper_radius": 0.1,
                },
                "initial_stress": {"kind": "geostatic", "surcharge": 10.0},
                "points_per_cell": 27,
                "velocity": [0.1, 0.0, 0.0],
            },
            CUBE["body"][0]
            | {
                "shape": {
                    "kind": "cylinder",
                    "center": [0.1, 0.0, 0.1],
                    "radius": 0.1,
                    "height": 0.8,
                    "axis": [0, 1, 0],
                }
            },
            CUBE["body"][0] | {"shape": {"kind": "sphere", "center": [1.0, 0.4, 0.2], "radius": 0.2}, "clip": True},
        ],
    },
)
ROUND = changed(
    RING,
    {
        "grid.lower": [0.1, 0.0],
        "boundary": {"left": {"kind": "no_slip", "velocity": 0.1}, "bottom": {"kind": "friction", "coefficient": 0.5}},
        "body.0.clip": True,
        "body.0.initial_stress": {"kind": "geostatic", "horizontal_ratio": 0.5},
    },
)
MOVED = changed(
    BLOCK,
    {
        "obstacle": [
            {
                "name": "ground",
                "friction": 0.3,
                "shape": {"kind": "terrain", "points": [[0.0, 0.05], [0.5, 0.1], [1.0, 0.05]]},
            },
            {
                "name": "slope",
                "friction": 0.0,
                "shape": {"kind": "plane", "point": [0.05, 0.0], "normal": [1.0, 0.5]},
                "until": 0.05,
            },
            {
                "name": "blade",
                "friction": 0.3,
                "shape": {"kind": "line", "points": [[0.8, 0.2], [0.8, 0.4]], "thickness": 0.02},
                "motion": {"time": [0.0, 0.1], "displacement": [[0.0, 0.0], [0.1, 0.0]], "angle": [0.0, 0.5]},
            },
            {
                "name": "ball",
                "friction": 0.3,
                "shape": {"kind": "disc", "center": [0.5, 0.7], "radius": 0.05},
                "free": {"density": 2000.0, "velocity": [0.0, -1.0], "angular_velocity": 1.0},
            },
        ],
    },
)
MOTION = "t,x,y,angle\n0,0,0,0\n0.1,0.1,0,0.5\n0.2,0.1,0.1,0.5\n"


def read_motion(path: Path) -> object:
    """As that of an obstacle."""
    scene = path.parent / "scene.toml"
    scene.write_text(tomli_w.dumps(changed(MOVED, {"obstacle.2.motion": {"file": path.name}})))
    return set_up(scene)
