"""Two laws in one scene and in one process: neither may take the other's code, columns or parameters.

The compiled code of two laws differs in what it closes over alone; loaded from the disk cache it was once mixed up.
"""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scenes_for_tests import CAM_CLAY, COLUMN, MU_I_LC
from stretched_law import COMPILED_STEP, printed, write_law

from grainlaw.materials import get_material
from grainlaw.mpm_core import Scene, Simulation

STEPS, DT = 60, 2e-4
LAWS = {"mu_i_lc": MU_I_LC, "modified_cam_clay": CAM_CLAY}
STRESS = {"kind": "geostatic", "out_of_plane_ratio": 0.3}


def scene(*laws):
    """A column of each law; they stand too far apart to feel one another."""
    lower = {"mu_i_lc": 0.5, "modified_cam_clay": 2.4}
    bodies = [
        {
            "material": law,
            "density": 1500.0,
            "initial_stress": STRESS,
            "shape": {"kind": "rectangle", "lower": [lower[law], 0.0], "upper": [lower[law] + 0.3, 0.4]},
        }
        for law in laws
    ]
    return Scene.from_dict(COLUMN | {"material": {law: LAWS[law] for law in laws}, "body": bodies})


def columns_after_some_steps(*laws):
    simulation = Simulation(scene(*laws))
    for _ in range(STEPS):
        simulation.step(DT)
    ordered = {}
    for body in simulation.bodies:
        ordered[body.law.name] = body.points[:, np.argsort(body.ids)]
    return ordered


@pytest.mark.parametrize("law", LAWS)
def test_a_column_falls_as_if_the_one_of_another_law_were_not_there(law):
    alone, together = columns_after_some_steps(law)[law], columns_after_some_steps(*LAWS)[law]
    scale = np.abs(alone).max(axis=1, keepdims=True)
    np.testing.assert_allclose(together / np.maximum(scale, 1e-300), alone / np.maximum(scale, 1e-300), atol=1e-7)


def test_code_of_two_laws_from_the_disk_cache_is_not_mixed_up():
    """Each law's code is put on disk by a process of its own; one that loads both must agree with this one."""
    script = (
        "import sys; sys.path.insert(0, sys.argv[1]); import test_two_laws as t; "
        "print([repr(float(v.sum())) for v in t.columns_after_some_steps(*sys.argv[2:]).values()])"
    )
    folder = Path(__file__).parent

    def sums(*laws):
        command = [sys.executable, "-c", script, folder, *laws]
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout

    for law in LAWS:
        sums(law)
    here = [repr(float(values.sum())) for values in columns_after_some_steps(*LAWS).values()]
    assert sums(*LAWS) == f"{here}\n"


# One compiled step of the fluid of each of some law files; prints where the last of them ends.
STEP_OF_FILES = (
    "import sys; from pathlib import Path; from grainlaw.materials import SymmetricTensor, isotropic; "
    "from grainlaw.materials.registry import Registry; "
    "from grainlaw.materials.compilation import make_single_step, pointwise_law\n"
    "for path in map(Path, sys.argv[1:]):\n"
    "    found = Registry(); found.load_file(path); law = found.get('newtonian').law\n"
    "    values = law.parameter_sets['glycerol'].parameters; stress = isotropic(-1.0)\n"
    "    state = law.initial_state(stress, 1261.0, values)\n"
    "    step = make_single_step(pointwise_law(law))\n"
    "    end = step(stress, SymmetricTensor(1.0, *5 * (0.0,)), 1261.0, state, values, 1e-5)\n"
    "print([tuple(v) for v in end])"
)


def test_a_copy_of_a_law_leaves_nothing_in_the_disk_cache_that_the_law_stumbles_over(tmp_path):
    """The copy runs first, in a process of its own; its module does not exist in the next."""
    printed = []
    for name in ("first_copy", "second_copy"):
        path = tmp_path / f"{name}.py"
        path.write_text(get_material("newtonian").source_file.read_text())
        command = [sys.executable, "-c", STEP_OF_FILES, path]
        printed.append(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    assert printed[0] == printed[1]


def test_laws_from_two_files_of_the_same_name_leave_in_the_disk_cache_what_the_next_process_can_load(tmp_path):
    text = get_material("newtonian").source_file.read_text()
    paths = [tmp_path / folder / "fluid.py" for folder in ("one", "other")]
    for path in paths:
        path.parent.mkdir()
        path.write_text(f"{text}\n# {path.parent.name}\n")
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    printed = [
        subprocess.run(
            [sys.executable, "-c", STEP_OF_FILES, *given], env=environment, check=True, capture_output=True, text=True
        ).stdout
        for given in (paths, paths[1:])
    ]
    assert printed[0] == printed[1]


# Long enough not to be inlined, so that the linker sees its name.
CLOSURES = """
import math
from numba import njit


def made(c):
    @njit
    def factor(x):
        y = 0.0
        for i in range(50):
            y += math.sin(i * x) + math.exp(-i * x) + math.tan(i + x) + math.atan2(x, i + 1.0) + math.log(x + i + 1)
            y -= math.sinh(x) + math.cos(x + i * i) + math.log(x + i + 2) + math.sin(x * i * i) + math.atan2(x, i + 2.0)
        return c * x + 0.0 * y

    return factor
"""


def test_closures_of_two_laws_from_one_factory_are_not_mixed_up(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "closures.py").write_text(CLOSURES)
    laws = [
        write_law(tmp_path / f"law_{number}.py", f"from closures import made\n\nfactor = made({number})", "factor(1.0)")
        for number in (1.0, 2.0)
    ]
    environment = {"PYTHONPATH": tmp_path / "elsewhere", "NUMBA_CACHE_DIR": tmp_path / "cache"}
    found = [printed("-c", COMPILED_STEP, *given, **environment).split() for given in (laws[:1], laws[1:], laws)]
    assert [float(value) for value in found[2]] == pytest.approx([1.0, 2.0])
    assert found[0] + found[1] == found[2]
