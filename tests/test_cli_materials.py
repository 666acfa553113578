"""`grainlaw materials`: what it lists, what it refuses, and with which exit code."""

import json
import subprocess
import sys

import pytest
from scenes_for_tests import grainlaw

from grainlaw.materials import get_material

FAULTY_PLUGIN = """
from typing import Annotated, NamedTuple
from grainlaw.materials import Law, Parameter, hookimpl


class Parameters(NamedTuple):
    stiffness: Annotated[float, Parameter("", "stiffness")]


class State(NamedTuple):
    pass


def function(*arguments):
    return None


@hookimpl
def grainlaw_materials():
    return [Law("unitless", "a law without a unit", Parameters, State, function, function, function)]
"""


def test_list_names_every_law_and_its_origin():
    done = grainlaw("materials")
    assert done.returncode == 0
    for name in ("linear_elastic", "modified_cam_clay", "mu_i_lc", "mu_i_lc_viscous"):
        assert name in done.stdout
    assert "grainlaw 0." in done.stdout


def test_description_has_every_declaration():
    done = grainlaw("materials", "modified_cam_clay")
    law = get_material("modified_cam_clay")
    for name in (*law.parameter_declarations, *law.state_declarations, *law.parameter_sets):
        assert name in done.stdout


def test_json_agrees_with_the_declarations():
    found = json.loads(grainlaw("materials", "mu_i_lc", "--json").stdout)
    law = get_material("mu_i_lc")
    units = {item["name"]: item["unit"] for item in found["parameters"]}
    assert units == {name: declaration.unit for name, declaration in law.parameter_declarations.items()}
    assert found["parameter_sets"][0]["values"] == law.parameter_sets["paper"].parameters._asdict()
    assert len(json.loads(grainlaw("materials", "--json").stdout)) >= 4


def test_listing_does_not_load_the_compiler():
    code = (
        "import sys; sys.argv = ['grainlaw', 'materials']\n"
        "from grainlaw.cli.main import main\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "print('loaded:', [name for name in ('numba', 'matplotlib', 'scipy', 'vtk', 'pyvista') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "loaded: []"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["materials", "mu_lc"], "error: unknown law 'mu_lc'; did you mean 'mu_i_lc'?"),
        (["materials", "--plugin", "absent.py"], "error: plugin absent.py: import raises FileNotFoundError"),
    ],
)
def test_wrong_request_is_one_line_and_exit_2(arguments, message):
    done = grainlaw(*arguments)
    assert done.returncode == 2
    assert done.stderr.startswith(message)
    assert done.stderr.count("\n") == 1


def test_plugin_without_a_unit_is_refused(tmp_path):
    path = tmp_path / "unitless.py"
    path.write_text(FAULTY_PLUGIN)
    done = grainlaw("materials", "--plugin", str(path))
    assert done.returncode == 2
    assert "law 'unitless': 'stiffness' declares no unit" in done.stderr


def test_version_and_usage():
    assert grainlaw("--version").stdout.startswith("grainlaw 0.")
    assert grainlaw("no-such-command").returncode == 2
