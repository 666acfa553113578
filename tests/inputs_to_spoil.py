"""Good inputs of every kind, and the functions that read them as the commands do."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import tomli_w
from grains_for_tests import WRITERS, block
from meshes_to_spoil import SOLID_FILES, mesh_file, read_mesh, read_solid, solid_file
from points_for_tests import WRITERS as POINT_WRITERS
from points_for_tests import block as block_of_points
from runs_to_spoil import RUN_FILES, checkpoint_file, read_run, read_state, resume_vtkhdf, run_file, vtkhdf_file
from scenes_for_tests import BLOCK, COLUMN, changed
from scenes_to_spoil import MANY, MOTION, MOVED, ROUND, SOLIDS, TWO, read_motion, scene_file, set_up

from grainlaw.materials.calibration.data import read_data
from grainlaw.materials.element.catalogue import get_element_test
from grainlaw.materials.element.mixed import read_control
from grainlaw.materials.element.specimen import prepared
from grainlaw.materials.registry import get_material
from grainlaw.mpm_core.space import PLANE_STRAIN
from grainlaw.validation.grains.observation import write_observation
from grainlaw.validation.grains.observe import observe_folder
from grainlaw.validation.grains.reference_file import load_reference
from grainlaw.validation.mpm import state as other_code


class Subject(NamedTuple):
    """A kind of input: writers of good files into an empty folder, each the path of one file; and how it is read."""

    good: dict[str, Callable[[Path], Path]]
    read: Callable[[Path], object]


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


def _points(form: str) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        places = block_of_points(0.3)[::11]
        return POINT_WRITERS[form](folder, places, np.ones(len(places)))

    return write


def read_points_of_others(path: Path) -> object:
    """Beside the paper's column."""
    return other_code.read_state(path).observed(other_code.Start(0.27, 0.02), PLANE_STRAIN, 1.0)


def _observation(folder: Path) -> Path:
    _dumps("hdf5", "")(folder)
    path = folder / "reference.h5"
    write_observation(path, observe_folder(folder))
    return path


def subjects() -> dict[str, Subject]:
    """All kinds of input."""
    laws = ("mu_i_lc", "modified_cam_clay", "mu_i_mcc", "mu_i_phi_i", "newtonian", "neo_hookean", "drucker_prager")
    dumps = {f"{form} {spoils or 'dump'}": _dumps(form, spoils) for form in WRITERS for spoils in ("", "run.json")}
    around = {"space": "axisymmetric", "solid_fraction": 0.6, "axis": [0.0, 0.03]}
    dumps |= {f"around {spoils or 'dump'}": _dumps("csv", spoils, **around) for spoils in ("", "run.json")}
    meshes = {
        "msh 2.2": mesh_file("body.msh", file_format="gmsh22", binary=False),
        "msh 2.2 binary": mesh_file("body.msh", file_format="gmsh22", binary=True),
        "msh 4.1": mesh_file("body.msh", file_format="gmsh", binary=False),
        "vtk": mesh_file("body.vtk", binary=False),
        "vtu": mesh_file("body.vtu", binary=False),
        "med": mesh_file("body.med"),
        "xdmf": mesh_file("body.xdmf"),
        "xdmf data": mesh_file("body.xdmf", spoils="body.h5"),
    }
    clay = get_material("modified_cam_clay")
    return {
        "scene": Subject({"many": scene_file(MANY), "two": scene_file(TWO), "column": scene_file(COLUMN)}, set_up),
        "scene in space": Subject({"solids": scene_file(SOLIDS), "round": scene_file(ROUND)}, set_up),
        "obstacles": Subject({"moved": scene_file(MOVED)}, set_up),
        "motion": Subject({"motion": _text("motion.csv", MOTION)}, read_motion),
        "solid": Subject({name: solid_file(name) for name in SOLID_FILES}, read_solid),
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
        "points": Subject({form: _points(form) for form in POINT_WRITERS}, read_points_of_others),
        "observation": Subject({"hdf5": _observation}, load_reference),
        "mesh": Subject(meshes, read_mesh),
        "checkpoint": Subject(
            {"sealed": checkpoint_file(sealed=True), "older": checkpoint_file(sealed=False)}, read_state
        ),
        "vtkhdf": Subject({"vtkhdf": vtkhdf_file}, resume_vtkhdf),
        "run": Subject({name: run_file(name) for name in RUN_FILES}, read_run),
    }
