"""A law whose stiffness grows with pressure wants an initial stress: a scene without one is warned about."""

import warnings

import pytest
from scenes_for_tests import BLOCK, CAM_CLAY, changed, grainlaw, write_scene

import grainlaw as gl
from grainlaw.materials import get_material
from grainlaw.mpm_core import Scene
from grainlaw.mpm_core.scene.initial_state import build_bodies

LAWS = {
    "modified_cam_clay": CAM_CLAY,
    "mu_i_mcc": get_material("mu_i_mcc").parameter_sets["paper"].parameters._asdict(),
}
UNIFORM = {"kind": "uniform", "pressure": 5.0}


def clay(law="modified_cam_clay", initial_stress=None, **parameters):
    """The block made of Cam Clay, for one step."""
    changes = {
        "material": {law: {**LAWS[law], **parameters}},
        "body.0.material": law,
        "time": {"end": 1e-4, "step": 1e-4},
        "output": {"pictures": False},
    }
    if initial_stress:
        changes["body.0.initial_stress"] = initial_stress
    return changed(BLOCK, changes)


def built(content):
    """The bodies of a scene; nothing has to be compiled for them."""
    return build_bodies(Scene.from_dict(content))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(
    ("initial_stress", "parameters"),
    [(None, {}), (UNIFORM, {"stress_free_pressure": 5.1}), ({"kind": "geostatic"}, {})],
    ids=["none", "below", "geostatic without gravity"],
)
def test_start_without_stiffness_is_warned_about(law, initial_stress, parameters):
    least = parameters.get("stress_free_pressure", 1.0)
    with pytest.warns(gl.InputWarning, match=rf"body\.0\.initial_stress: .* {least:g} Pa, where {law} .*\"geostatic\""):
        built(clay(law, initial_stress, **parameters))


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("least", [5.0, 4.9, 0.1])
def test_start_with_stiffness_is_not(precision, least):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        built(clay(initial_stress=UNIFORM, stress_free_pressure=least) | {"precision": precision})
        built(BLOCK)


def test_the_body_that_lacks_it_is_named():
    content = clay(initial_stress=UNIFORM)
    lower = content["body"][0] | {"shape": {"kind": "rectangle", "lower": [0.3, 0.0], "upper": [0.7, 0.2]}}
    del lower["initial_stress"]
    content["body"].append(lower)
    with pytest.warns(gl.InputWarning) as found:
        built(content)
    assert [str(warning.message).partition(": the")[0] for warning in found] == ["scene: body.1.initial_stress"]


def test_command_says_it_in_one_line_on_stderr(tmp_path):
    # Refused before the first step.
    scene = write_scene(tmp_path / "clay.toml", clay(), {"time.smallest_step": 1e-3})
    done = grainlaw("run", scene, "--out", tmp_path / "run")
    warning, error = done.stderr.splitlines()
    assert warning.startswith(f"warning: {scene}: body.0.initial_stress: ")
    assert error.startswith("error: ")


def test_run_from_python_warns(tmp_path):
    with pytest.warns(gl.InputWarning, match=r"body\.0\.initial_stress"), pytest.raises(gl.InputError):
        gl.run(changed(clay(), {"time.smallest_step": 1e-3}), tmp_path / "run")
