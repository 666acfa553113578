"""Compiled code is kept on disk, but never beyond an edit: a new process has the results of the new sources."""

import json
import shutil
from pathlib import Path

import pytest
import tomli_w
from scenes_for_tests import BLOCK
from stretched_law import COMPILED_STEP, command, printed, write_constant, write_law

ROOT = Path(__file__).resolve().parent.parent

# What stands above the law, and its factor; every one of them comes from the module `constants` of another folder.
WAYS = {
    "imported constant": ("from constants import C", "C"),
    "attribute of a module": ("import constants", "constants.C"),
    "function of a module": ("import constants", "constants.factor()"),
    "constant computed from another": ("from tables import TWICE", "0.5 * TWICE"),
    "constant of the law": ("import constants\nOWN = constants.C", "OWN"),
    "cell of a closure": (
        "from constants import C\n\n\ndef made(c):\n    @pointwise\n    def factor():\n        return c\n\n"
        "    return factor\n\n\nfactor = made(C)\n",
        "factor()",
    ),
    "default argument": ("from constants import C\n\n\n@pointwise\ndef factor(c=C):\n    return c\n", "factor()"),
    "function within the law": ("from constants import C", "(lambda x: C * x)(1.0)"),
    "function that is compiled already": (
        "from numba import njit\nfrom constants import C\n\n\n@njit\ndef factor():\n    return C\n",
        "factor()",
    ),
    "item of a NamedTuple": (
        "from constants import C\n\n\nclass Table(NamedTuple):\n    c: float\n\n\nTABLE = Table(C)\n",
        "TABLE.c",
    ),
    "member of an enumeration": (
        "from enum import IntEnum\nfrom constants import C\n\n\nclass Table(IntEnum):\n    C = int(C)\n",
        "(1.0 if Table.C == 1 else 2.0)",
    ),
    "array": ("import numpy as np\nfrom constants import C\nTABLE = np.array([C])", "TABLE[0]"),
    "number that no source holds": ("import os\nOWN = float(os.environ['FACTOR'])", "OWN"),
}


@pytest.fixture(scope="module")
def stretched(tmp_path_factory):
    """The stress of each law before and after the edit, from two processes."""
    folder = tmp_path_factory.mktemp("stale")
    paths = [
        write_law(folder / "laws" / f"{way.replace(' ', '_')}.py", above, factor)
        for way, (above, factor) in WAYS.items()
    ]
    (folder / "elsewhere").mkdir()
    (folder / "elsewhere" / "tables.py").write_text("import constants\n\nTWICE = 2.0 * constants.C\n")
    found = []
    for value in ("1.0", "2.00"):
        write_constant(folder / "elsewhere", value)
        environment = {"PYTHONPATH": folder / "elsewhere", "NUMBA_CACHE_DIR": folder / "cache", "FACTOR": value}
        found.append(map(float, printed("-c", COMPILED_STEP, *paths, **environment).split()))
    return dict(zip(WAYS, zip(*found, strict=True), strict=True))


@pytest.mark.parametrize("way", WAYS)
def test_an_edit_takes_effect_by_whatever_way_a_law_reaches_it(way, stretched):
    before, after = stretched[way]
    assert before == pytest.approx(1.0)
    assert after == pytest.approx(2.0)


def element(law, out, **environment):
    """The last stress of an element test, from the command line."""
    arguments = ("element", "isotropic", "--material", "stretched", "--plugin", law, "--out", out)
    printed("-m", "grainlaw", *arguments, **environment)
    heading, *_, last = out.read_text().splitlines()
    return dict(zip(heading.split(","), map(float, last.split(",")), strict=True))["stress_xx [Pa]"]


def test_element_test_has_the_results_of_an_edited_module(tmp_path):
    law, elsewhere = write_law(tmp_path / "law.py", *WAYS["imported constant"]), tmp_path / "elsewhere"
    environment = {"PYTHONPATH": elsewhere, "NUMBA_CACHE_DIR": tmp_path / "cache"}
    write_constant(elsewhere, "1.0")
    before = element(law, tmp_path / "before.csv", **environment)
    write_constant(elsewhere, "2.00")
    assert element(law, tmp_path / "after.csv", **environment) == pytest.approx(2.0 * before)


def test_element_test_has_the_results_of_an_edited_neighbour(tmp_path):
    law, environment = write_law(tmp_path / "law.py", *WAYS["imported constant"]), {"NUMBA_CACHE_DIR": tmp_path / "c"}
    write_constant(tmp_path, "1.0")
    before = element(law, tmp_path / "before.csv", **environment)
    write_constant(tmp_path, "2.0")
    assert element(law, tmp_path / "after.csv", **environment) == pytest.approx(2.0 * before)


def test_run_takes_the_steps_that_an_edited_module_asks_for(tmp_path):
    law, elsewhere, steps = write_law(tmp_path / "law.py", *WAYS["imported constant"]), tmp_path / "elsewhere", []
    body = BLOCK["body"][0] | {"material": "stretched"}
    scene = BLOCK | {"material": {"stretched": {"stiffness": 1e6}}, "body": [body]}
    (tmp_path / "scene.toml").write_text(tomli_w.dumps(scene))
    for value in ("1.0", "2.00"):
        write_constant(elsewhere, value)
        out = tmp_path / value
        arguments = ("run", tmp_path / "scene.toml", "--plugin", law, "--out", out, "--threads", "1")
        printed("-m", "grainlaw", *arguments, PYTHONPATH=elsewhere)
        steps.append(json.loads((out / "summary.json").read_text())["steps"])
    assert steps[1] == pytest.approx(2 * steps[0], rel=0.1)


def test_check_tries_the_edited_law(tmp_path):
    """Else it says that compiled code and plain Python differ."""
    law, elsewhere = write_law(tmp_path / "law.py", *WAYS["imported constant"]), tmp_path / "elsewhere"
    for value in ("1.0", "2.00"):
        write_constant(elsewhere, value)
        done = command("-m", "grainlaw", "check", "stretched", "--quick", "--plugin", law, PYTHONPATH=elsewhere)
        (line,) = [line for line in done.stdout.splitlines() if line.strip().startswith("compiled ")]
        assert "pass" in line


@pytest.fixture
def copied(tmp_path):
    """A copy of the library that may be edited."""
    for name in ("grainlaw", "materials", "mpm_core", "plugins", "validation"):
        without = shutil.ignore_patterns("__pycache__", "reference", "*.csv", "*.h5")
        shutil.copytree(ROOT / name, tmp_path / "copy" / name, symlinks=True, ignore=without)
    return tmp_path / "copy"


def edited(path, old, new):
    text = path.read_text()
    assert text.count(old) == 1
    path.write_text(text.replace(old, new))


def test_element_test_has_the_results_of_an_edited_helper_of_materials(copied, tmp_path):
    law = write_law(tmp_path / "law.py", "from grainlaw.materials import rheology", "rheology.shear_modulus(1.0, 0.2)")
    environment = {"PYTHONPATH": copied, "PYTHONSAFEPATH": 1, "NUMBA_CACHE_DIR": tmp_path / "cache"}
    before = element(law, tmp_path / "before.csv", **environment)
    edited(copied / "materials" / "rheology.py", "    return 1.5 * (1.0 - 2.0", "    return 3.00 * (1.0 - 2.0")
    assert element(law, tmp_path / "after.csv", **environment) == pytest.approx(2.0 * before)


INVARIANT = """
import numpy as np
from grainlaw.materials import equivalent_shear_stress
from grainlaw.mpm_core.kernels.invariants import over_stress
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.space import PLANE_STRAIN
points, values = np.zeros((40, 1)), np.empty(1)
points[layout_of(PLANE_STRAIN).stress + 3] = 1.0
over_stress(PLANE_STRAIN, equivalent_shear_stress)(points, values)
print(values[0])
"""


def test_kernel_of_the_core_has_the_results_of_an_edited_helper_of_materials(copied, tmp_path):
    environment = {"PYTHONPATH": copied, "PYTHONSAFEPATH": 1, "NUMBA_CACHE_DIR": tmp_path / "cache"}
    assert float(printed("-c", INVARIANT, **environment)) == pytest.approx(1.0)
    edited(
        copied / "materials" / "tensor.py",
        "return half_norm(deviator(stress))",
        "return 2.0 * half_norm(deviator(stress))",
    )
    assert float(printed("-c", INVARIANT, **environment)) == pytest.approx(2.0)


def test_an_unedited_law_is_not_compiled_again_wherever_its_file_lies(tmp_path):
    write_constant(tmp_path / "elsewhere", "1.0")
    environment = {"PYTHONPATH": tmp_path / "elsewhere", "NUMBA_CACHE_DIR": tmp_path / "cache", "NUMBA_DEBUG_CACHE": 1}
    logs = []
    for folder in ("here", "there"):
        law = write_law(tmp_path / folder / "law.py", *WAYS["function of a module"])
        logs.append(printed("-c", COMPILED_STEP, law, **environment))
    assert logs[0].count("data saved to") == 1
    assert "data saved to" not in logs[1]
    assert logs[1].count("data loaded from") == 1
