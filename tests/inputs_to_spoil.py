"""Good inputs of every kind, and the functions that read them as the commands do."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

import meshio
import numpy as np
import tomli_w
import trimesh
from grains_for_tests import WRITERS, block
from scenes_for_tests import BLOCK, COLUMN, CUBE, MU_I_LC, RING, changed

from grainlaw.materials.calibration.data import read_data
from grainlaw.materials.element.catalogue import get_element_test
from grainlaw.materials.element.mixed import read_control
from grainlaw.materials.element.specimen import prepared
from grainlaw.materials.registry import get_material
from grainlaw.mpm_core import Scene, simulation
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.output.checkpoint import (
    CHECKPOINT_NAME,
    Clock,
    how_to_go_on,
    read_checkpoint,
    refuse_other_laws,
    write_checkpoint,
)
from grainlaw.mpm_core.output.frame import Field, Frame
from grainlaw.mpm_core.output.frame_series import FrameSeries
from grainlaw.mpm_core.output.hdf5_file import USER_BLOCK
from grainlaw.mpm_core.output.history import HistoryWriter, history_columns
from grainlaw.mpm_core.output.prepare import cut_vtkhdf
from grainlaw.mpm_core.output.quantities import write_quantities
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.summary import FinalState, RunSummary, write_summary
from grainlaw.mpm_core.output.vtkhdf import VTKHDF_NAME, append_frame
from grainlaw.mpm_core.scene.mesh_file import SURFACE_FORMATS
from grainlaw.mpm_core.stepping import run
from grainlaw.validation.grains.observation import write_observation
from grainlaw.validation.grains.observe import observe_folder
from grainlaw.validation.grains.reference_file import load_reference


class Subject(NamedTuple):
    """A kind of input: writers of good files into an empty folder, each the path of one file; and how it is read."""

    good: dict[str, Callable[[Path], Path]]
    read: Callable[[Path], object]


def set_up(path: Path) -> object:
    """All that a run does before its kernels are compiled."""
    with mock.patch.object(Body, "choose_kernels"), mock.patch.object(simulation, "elastic_energy", return_value=0.0):
        built = run.built_simulation(Scene.load(path), 1)
        run.refuse_impossible_steps(built)
        return built.next_step(built.scene.time.end)


def _scene(content: dict[str, Any]) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        path = folder / "scene.toml"
        path.write_text(tomli_w.dumps(content))
        return path

    return write


def _parameters(law: str) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        path = folder / f"{law}.toml"
        parameters = next(iter(get_material(law).parameter_sets.values())).parameters
        path.write_text(tomli_w.dumps(parameters._asdict()))
        return path

    return write


def read_parameters(path: Path) -> object:
    """For an element test, and for a body of a scene."""
    name, test = path.stem, get_element_test("simple-shear")
    specimen, settings = prepared(name, path, {}, test)
    scene = path.parent / "scene.toml"
    changes = {
        "material": {name: {"parameters": path.name}},
        "body.0.material": name,
        "body.0.initial_stress": {"kind": "uniform", "pressure": 1000.0},
    }
    scene.write_text(tomli_w.dumps(changed(BLOCK, changes)))
    set_up(scene)
    return specimen.density(1000.0, settings.density)


def _text(name: str, text: str) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        path = folder / name
        path.write_text(text)
        return path

    return write


CONTROL = "time_step = 1e-3\n[[stage]]\nduration = 0.1\nstrain_rate = { yy = -0.01 }\nstress_rate = { xx = 0.0 }\n"
DATA = "# test = triaxial-drained\n# initial_pressure = 200e3\naxial_strain [1],deviatoric_stress [Pa]\n0.01,1e5\n"
DATA_OF_TESTS = "test,initial_pressure,axial_strain,deviatoric_stress [Pa],standard_error_deviatoric_stress [Pa]\n" + (
    "triaxial-drained,1e5,0.01,1e5,1e3\ntriaxial-undrained,2e5,0.02,,\n"
)
SURFACES = "# grain_diameter = 0.003\nt,x,h\n" + "".join(
    f"{t},{x},{max(0.0, 0.2 - abs(x) / (1 + t))}\n" for t in (0.0, 0.5) for x in (-0.3, -0.1, 0.0, 0.1, 0.3)
)

SURFACES_AROUND = "# grain_diameter = 0.003\n# space = axisymmetric\nt,x,h\n" + "".join(
    f"{t},{x},{max(0.0, 0.2 - x / (1 + t))}\n" for t in (0.0, 0.5) for x in (0.0, 0.1, 0.3)
)


def _dumps(form: str, spoils: str, **more: Any) -> Callable[[Path], Path]:
    """A run of a few grains in a format, of which `run.json` or the first dump is to be spoilt."""

    def write(folder: Path) -> Path:
        description: dict[str, Any] = {"depth": 0.06, "grain_density": 2450.0, "time_step": 1e-4, **more}
        files = [WRITERS[form](folder, number, block(0.03, 0.03)) for number in range(2)]
        frames = [{"file": file, "time": 0.1 * number} for number, file in enumerate(files)]
        (folder / "run.json").write_text(json.dumps({**description, "frames": frames}))
        return folder / (spoils or files[0])

    return write


def _observation(folder: Path) -> Path:
    _dumps("hdf5", "")(folder)
    path = folder / "reference.h5"
    write_observation(path, observe_folder(folder))
    return path


NODES = np.array([[0.3, 0.2], [0.5, 0.2], [0.7, 0.2], [0.3, 0.6], [0.5, 0.6], [0.7, 0.6]])
QUADS = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])


def _mesh(name: str, spoils: str = "", **options: Any) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        path = folder / name
        mesh = meshio.Mesh(np.column_stack([NODES, np.zeros(6)]), [("quad", QUADS)])
        mesh.write(path, **options)
        return folder / (spoils or name)

    return write


def read_mesh(path: Path) -> object:
    """As the shape of a body."""
    scene = path.parent / "scene.toml"
    path = path.with_suffix(".xdmf") if path.suffix == ".h5" else path
    scene.write_text(tomli_w.dumps(changed(BLOCK, {"body.0.shape": {"kind": "mesh", "file": path.name}})))
    return set_up(scene)


RUN_FILES = ("scene.toml", "summary.json", "history.csv", "quantities.csv", "run.pvd", "points_000000.vtu")
SUMMARY = RunSummary(
    **dict.fromkeys(("scene", "material", "version"), "a"),
    **dict.fromkeys(("points", "cells", "steps", "peak_memory_bytes", "threads"), 1),
    **dict.fromkeys(("simulated_time", "wall_time", "compile_time", "point_steps_per_second"), 1.0),
    mass_left=0.0,
    points_left=0,
    final=FinalState(runout=0.1, height=0.1, center_of_mass_height=0.05, kinetic_energy=0.0),
    energy_balance_error=0.01,
    limited={"points_at_a_wall": 1},
)


def _run(spoils: str) -> Callable[[Path], Path]:
    """The folder of a finished run, of which one file is to be spoilt."""

    def write(folder: Path) -> Path:
        _scene(BLOCK)(folder)
        frames, history = FrameSeries(folder), HistoryWriter(folder)
        for step in range(2):
            frames.write(_frame(step))
            history.append({column.name: step for column in history_columns()})
        write_quantities(folder, _frame(0).fields)
        write_summary(folder, SUMMARY)
        return folder / spoils

    return write


def read_run(path: Path) -> object:
    """All parts of a run's folder."""
    run_folder = RunFolder(path.parent)
    parts = run_folder.scene, run_folder.summary, run_folder.history["t"], run_folder.frame_times
    return [*parts, *(run_folder.load_frame(number).field("pressure") for number in range(len(run_folder.frame_files)))]


def _simulation() -> simulation.Simulation:
    """A block of a few points, whose kernels are not compiled."""
    with mock.patch.object(Body, "choose_kernels"), mock.patch.object(simulation, "elastic_energy", return_value=0.0):
        return simulation.Simulation(Scene.from_dict(BLOCK), 1)


def _checkpoint(*, sealed: bool) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        write_checkpoint(folder, _simulation(), Clock())
        path = folder / CHECKPOINT_NAME
        if not sealed:
            path.write_bytes(path.read_bytes()[USER_BLOCK:])
        return path

    return write


def read_state(path: Path) -> object:
    """What `--resume` asks of a checkpoint, and what it reads."""
    built = _simulation()
    refuse_other_laws(path.parent, [body.law for body in built.bodies])
    return how_to_go_on(path.parent), read_checkpoint(path.parent, built)


def _frame(step: int) -> Frame:
    fields = (Field("pressure", "Pa", "mean pressure", np.arange(6.0)),)
    return Frame(0.1 * step, step, np.column_stack([NODES, np.zeros(6)]), fields)


def _vtkhdf(folder: Path) -> Path:
    for step in range(3):
        append_frame(folder / VTKHDF_NAME, _frame(step))
    return folder / VTKHDF_NAME


def resume_vtkhdf(path: Path) -> None:
    """Cut the frames off and go on, as `--resume` does without VTU frames."""
    cut_vtkhdf(path, 0.1)
    append_frame(path, _frame(2))


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


TETRAHEDRON = np.array([[0.3, 0.2, 0.1], [0.7, 0.2, 0.1], [0.3, 0.6, 0.1], [0.3, 0.2, 0.5]])


def _solid(name: str) -> Callable[[Path], Path]:
    """A surface or, in a format for volumes, a tetrahedron."""

    def write(folder: Path) -> Path:
        path = folder / name
        faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        if path.suffix in SURFACE_FORMATS:
            trimesh.Trimesh(TETRAHEDRON, faces).export(path)
        else:
            meshio.Mesh(TETRAHEDRON, [("tetra", np.arange(4)[None])]).write(path)
        return path

    return write


def read_solid(path: Path) -> object:
    """As the shape of a body in 3D."""
    scene = path.parent / "scene.toml"
    scene.write_text(tomli_w.dumps(changed(CUBE, {"body.0.shape": {"kind": "mesh", "file": path.name}})))
    return set_up(scene)


def subjects() -> dict[str, Subject]:
    """All kinds of input."""
    laws = ("mu_i_lc", "modified_cam_clay", "mu_i_mcc", "mu_i_phi_i", "newtonian", "neo_hookean", "drucker_prager")
    dumps = {f"{form} {spoils or 'dump'}": _dumps(form, spoils) for form in WRITERS for spoils in ("", "run.json")}
    around = {"space": "axisymmetric", "solid_fraction": 0.6, "axis": [0.0, 0.03]}
    dumps |= {f"around {spoils or 'dump'}": _dumps("csv", spoils, **around) for spoils in ("", "run.json")}
    meshes = {
        "msh 2.2": _mesh("body.msh", file_format="gmsh22", binary=False),
        "msh 2.2 binary": _mesh("body.msh", file_format="gmsh22", binary=True),
        "msh 4.1": _mesh("body.msh", file_format="gmsh", binary=False),
        "vtk": _mesh("body.vtk", binary=False),
        "vtu": _mesh("body.vtu", binary=False),
        "med": _mesh("body.med"),
        "xdmf": _mesh("body.xdmf"),
        "xdmf data": _mesh("body.xdmf", spoils="body.h5"),
    }
    clay = get_material("modified_cam_clay")
    return {
        "scene": Subject({"many": _scene(MANY), "two": _scene(TWO), "column": _scene(COLUMN)}, set_up),
        "scene in space": Subject({"solids": _scene(SOLIDS), "round": _scene(ROUND)}, set_up),
        "obstacles": Subject({"moved": _scene(MOVED)}, set_up),
        "motion": Subject({"motion": _text("motion.csv", MOTION)}, read_motion),
        "solid": Subject({name: _solid(name) for name in ("a.stl", "a.ply", "a.obj", "a.off", "a.vtk")}, read_solid),
        "parameters": Subject({law: _parameters(law) for law in laws}, read_parameters),
        "data": Subject(
            {"one": _text("data.csv", DATA), "tests": _text("data.csv", DATA_OF_TESTS)},
            lambda path: read_data(path, clay),
        ),
        "control": Subject({"control": _text("control.toml", CONTROL)}, lambda path: read_control(path).steps),
        "surface": Subject(
            {"surface": _text("surface.csv", SURFACES), "around": _text("surface.csv", SURFACES_AROUND)}, load_reference
        ),
        "dump": Subject(dumps, lambda path: observe_folder(path.parent)),
        "observation": Subject({"hdf5": _observation}, load_reference),
        "mesh": Subject(meshes, read_mesh),
        "checkpoint": Subject({"sealed": _checkpoint(sealed=True), "older": _checkpoint(sealed=False)}, read_state),
        "vtkhdf": Subject({"vtkhdf": _vtkhdf}, resume_vtkhdf),
        "run": Subject({name: _run(name) for name in RUN_FILES}, read_run),
    }
