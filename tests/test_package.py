"""grainlaw from its wheel, outside any checkout: what it holds, that all of it runs, and a user's files of any name."""

import ast
import hashlib
import json
import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from importlib.metadata import version
from pathlib import Path

import pytest
from documentation import ROOT
from installation import build_wheel

FOLDERS = ("materials", "plugins", "mpm_core", "validation", "scenes")
SHORT = ("--set", "time.end=0.01", "--set", "output.pictures=false", "--threads", "1")


def contents(wheel: Path) -> dict[str, str]:
    """The hash of each file of a wheel by name."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: hashlib.sha256(archive.read(name)).hexdigest() for name in archive.namelist()}


def tracked_files() -> set[str]:
    """The files of the package in the checkout, under the names that they have in it."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True)
    found = set()
    for name in filter(None, listed.stdout.split("\0")):
        top = name.partition("/")[0]
        if (top in FOLDERS or top == "grainlaw") and not (ROOT / name).is_symlink():
            found.add(name if top == "grainlaw" else f"grainlaw/{name}")
    return found


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="the checkout says which files there are")
def test_wheel_holds_every_file_of_the_package_and_nothing_else(installation):
    held = {name for name in contents(installation.wheel) if ".dist-info/" not in name}
    assert held == tracked_files()


def test_source_distribution_holds_no_tests_and_nothing_twice(installation):
    with tarfile.open(installation.sdist) as archive:
        names = [member.name.partition("/")[2] for member in archive.getmembers() if member.isfile()]
        links = [member.name for member in archive.getmembers() if member.issym() or member.islnk()]
    assert links == []
    tops = {name.partition("/")[0] for name in names}
    assert tops == {
        "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md", "LICENSE", "MANIFEST.in", "PKG-INFO", "README.md",
        "grainlaw", "grainlaw.egg-info", "pyproject.toml", "setup.cfg",
    }  # fmt: skip
    assert len(names) == len(set(names))


def test_wheels_of_checkout_and_source_distribution_are_the_same(installation, tmp_path):
    of_checkout = contents(build_wheel(installation.sources, tmp_path / "wheel"))
    of_sdist = contents(installation.wheel)
    assert of_checkout.keys() == of_sdist.keys()
    assert [name for name, mark in of_checkout.items() if of_sdist[name] != mark and "RECORD" not in name] == []


def test_versions_agree():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    citation = (ROOT / "CITATION.cff").read_text()
    assert re.findall(r"^version: (.*)$", citation, re.M) == [project["version"]]
    assert re.findall(r"^license: (.*)$", citation, re.M) == [project["license"]]
    assert project["version"] == version("grainlaw")
    changes = (ROOT / "CHANGELOG.md").read_text()
    assert project["version"] in changes


def test_only_grainlaw_is_importable(installation, tmp_path):
    names = [*FOLDERS, "benchmarks", "tests", "grainlaw"]
    program = f"""
import importlib.util, json
print(json.dumps([name for name in {names!r} if importlib.util.find_spec(name)]))
"""
    assert json.loads(installation.run("python", "-c", program, folder=tmp_path).stdout) == ["grainlaw"]


@pytest.mark.parametrize("folder", ["materials", "plugins", "mpm_core", "validation"])
def test_a_folder_under_its_old_name_says_what_to_import(folder, tmp_path):
    done = subprocess.run(
        [sys.executable, "-S", "-c", f"import {folder}"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.stderr.splitlines()[-1] == f"ImportError: import grainlaw.{folder}, not {folder}"


def test_scenes_are_listed_and_run_by_name(installation, tmp_path):
    listed = installation.run("grainlaw", "scenes", folder=tmp_path).stdout
    for path in (ROOT / "scenes").glob("*.toml"):
        assert path.stem in listed
    installation.run("grainlaw", "run", "two_discs", *SHORT, folder=tmp_path)
    assert json.loads((tmp_path / "runs" / "two_discs" / "summary.json").read_text())["points"] == 1624


def test_a_file_of_the_name_of_a_shipped_scene_is_taken_first(installation, tmp_path):
    (tmp_path / "two_discs").write_text("title = 3\n")
    done = installation.run("grainlaw", "run", "two_discs", folder=tmp_path, code=2)
    assert done.stderr.startswith("error: two_discs: ")


def test_unknown_scene_is_one_line_with_the_nearest_name(installation, tmp_path):
    done = installation.run("grainlaw", "plan", "colapse_mu_i_lc", folder=tmp_path, code=2)
    assert done.stderr.count("\n") == 1
    assert "did you mean 'collapse_mu_i_lc'?" in done.stderr


@pytest.mark.parametrize(
    ("command", "answer"),
    [
        (("validate", "--quick", "sliding_block", "mcc_triaxial_undrained"), "2 of 2 cases pass"),
        (("check", "linear_elastic", "--quick"), "passes every check"),
        (("new-law", "wet_sand"), "next: cd wet-sand"),
        (("element", "simple-shear", "--material", "linear_elastic", "--plot", "shear.png"), "wrote shear.png"),
        (("calibrate", "mu_i_lc", "plane_shear_liggghts", "--fit", "static_friction", "--out", "fit"), "parameters"),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_command_works_outside_a_checkout(command, answer, installation, tmp_path):
    assert answer in installation.run("grainlaw", *command, folder=tmp_path).stdout


USERS_FILES = ("materials.py", "validation.py", "mpm_core.py", "scenes.py", "plugins/__init__.py")
USE = """
import materials, mpm_core, plugins, scenes, validation
import grainlaw as gl

assert [one.MINE for one in (materials, mpm_core, plugins, scenes, validation)] == [7] * 5
assert gl.law("linear_elastic").element_test("simple-shear", final_strain=0.01)["pressure"][-1] > 0.0
scene = gl.Scene("two_discs", {"time.end": 0.01, "output.pictures": False})
run = gl.run(scene, "of_python", threads=1)
assert run.history["t"][-1] == 0.01
print("all of it is mine and works")
"""


@pytest.fixture
def users_folder(tmp_path):
    """A folder whose files bear the names of grainlaw's folders."""
    for name in USERS_FILES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("MINE = 7\n")
    return tmp_path


def test_a_script_beside_files_of_any_name(installation, users_folder):
    (users_folder / "script.py").write_text(USE)
    assert installation.run("python", "script.py", folder=users_folder).stdout.endswith("mine and works\n")


def test_the_command_beside_files_of_any_name(installation, users_folder):
    done = installation.run("python", "-m", "grainlaw", "run", "two_discs", *SHORT, folder=users_folder)
    assert "1624 points" in done.stdout
    installation.run("python", "-m", "grainlaw", "validate", "--list", folder=users_folder)


def test_pytest_beside_files_of_any_name(installation, users_folder):
    body = "".join(f"    {line}\n" for line in USE.splitlines() if line)
    (users_folder / "test_mine.py").write_text(f"def test_mine():\n{body}")
    done = installation.run("python", "-m", "pytest", "-q", "-p", "no:cacheprovider", folder=users_folder)
    assert "1 passed" in done.stdout


def test_a_notebook_beside_files_of_any_name(installation, users_folder):
    program = f"""
import nbclient, nbformat
from nbformat.v4 import new_code_cell, new_notebook

notebook = new_notebook(cells=[new_code_cell({USE!r}), new_code_cell("gl.law('mu_i_lc')")])
nbclient.NotebookClient(notebook, timeout=300).execute()
print(nbformat.writes(notebook))
"""
    done = json.loads(installation.run("python", "-c", program, folder=users_folder).stdout)
    shown, law = (cell["outputs"] for cell in done["cells"])
    assert any("<progress" in "".join(output.get("data", {}).get("text/html", "")) for output in shown)
    assert "static_friction" in "".join(law[0]["data"]["text/html"])


def test_every_module_has_annotations_for_editors():
    assert (ROOT / "grainlaw" / "py.typed").is_file()
    # What __getattr__ gives is what a type checker sees.
    tree = ast.parse((ROOT / "grainlaw" / "__init__.py").read_text())
    seen = {alias.asname for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) for alias in node.names} - {
        None
    }
    import grainlaw

    assert seen == set(grainlaw.__all__)
    assert all(hasattr(grainlaw, name) for name in grainlaw.__all__)
