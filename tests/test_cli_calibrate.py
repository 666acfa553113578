"""`grainlaw calibrate`: results, files, error lines and exit codes."""

import json
import tomllib

import pytest
from scenes_for_tests import grainlaw
from test_calibration import SHEAR_DATA

FIT = ("--fit", "static_friction", "--fit", "dynamic_friction", "--fix", "inertial_number_constant=0.15")


def test_output_and_files_hold_the_estimates(tmp_path):
    done = grainlaw("calibrate", "mu_i_lc", str(SHEAR_DATA), *FIT, "--out", str(tmp_path / "fit"))
    assert done.returncode == 0, done.stderr
    assert "dynamic_friction = 0.70558   95 %: [0.6114, 0.7998]" in done.stdout
    assert "note: solid_fraction of plane_shear_liggghts.csv depends on no fitted parameter" in done.stdout
    written = tomllib.loads((tmp_path / "fit" / "parameters.toml").read_text())
    result = json.loads((tmp_path / "fit" / "calibration.json").read_text())
    assert written["static_friction"] == result["estimates"][0]["value"] == pytest.approx(0.4888, abs=1e-4)
    assert written["inertial_number_constant"] == result["not_fitted"]["inertial_number_constant"] == 0.15
    assert (tmp_path / "fit" / "fit.png").read_bytes().startswith(b"\x89PNG")
    element = grainlaw(
        "element", "simple-shear", "--material", "mu_i_lc", "--parameters", str(tmp_path / "fit" / "parameters.toml"),
        "--set", "time_step=0.1",
    )  # fmt: skip
    assert element.returncode == 0, element.stderr
    assert f"static_friction = {written['static_friction']:.9g}" in element.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["mu_lc", str(SHEAR_DATA)], "unknown law 'mu_lc'; did you mean 'mu_i_lc'?"),
        (["mu_i_lc", "absent.csv"], "absent.csv cannot be read"),
        (["mu_i_lc", str(SHEAR_DATA), "--fit", "static_frction"], "did you mean 'static_friction'?"),
        (["mu_i_lc", str(SHEAR_DATA), "--fix", "static_friction"], "--fix static_friction: expected name=value"),
        (["mu_i_lc", str(SHEAR_DATA), "--fix", "static_friction=-1"], "allowed: [0, inf)"),
        (["mu_i_lc", str(SHEAR_DATA), "--fix", "static_friction=a"], "--fix static_friction=a: 'a' is not a number"),
        (["mu_i_lc", str(SHEAR_DATA), *FIT, "--fit", "inertial_number_constant"], "is both to be fitted and fixed"),
        (["mu_i_lc", str(SHEAR_DATA), "--fit", "poisson_ratio"], "the data depend on no free parameter"),
        (["mu_i_lc", str(SHEAR_DATA), "--parameters", "papr"], "did you mean 'paper'?"),
    ],
)
def test_wrong_request_is_one_line_and_exit_2(arguments, message):
    done = grainlaw("calibrate", *arguments)
    assert done.returncode == 2, done.stderr
    assert done.stderr.startswith("error: ")
    assert message in done.stderr
    assert done.stderr.count("\n") == 1
