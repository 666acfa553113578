"""What an element test is made of: parameter sets, files, assignments; and the table that it writes."""

import csv

import numpy as np
import pytest

from grainlaw.materials import InputError, get_material
from grainlaw.materials.element.catalogue import get_element_test
from grainlaw.materials.element.run import run_element_test
from grainlaw.materials.element.specimen import prepared

SHEAR = get_element_test("constant-pressure-shear")


def test_first_parameter_set_is_the_default_and_is_named():
    specimen, _ = prepared("mu_i_lc", None, {}, SHEAR)
    assert specimen.parameters == get_material("mu_i_lc").parameter_sets["paper"].parameters
    assert "set 'paper'" in specimen.source


def test_assignment_reaches_the_law_or_the_test():
    specimen, settings = prepared("mu_i_lc", None, {"dynamic_friction": 2.0, "time_step": 1e-4}, SHEAR)
    assert specimen.parameters.dynamic_friction == 2.0
    assert settings.time_step == 1e-4
    assert "with dynamic_friction = 2" in specimen.source


def test_grains_of_the_law_set_those_of_the_test():
    _, settings = prepared("mu_i_lc", None, {"grain_diameter": 0.002}, SHEAR)
    assert settings.grain_diameter == 0.002
    _, settings = prepared("linear_elastic", None, {}, SHEAR)
    assert (settings.grain_diameter, settings.grain_density) == (0.005, 2450.0)


def test_values_of_a_file_replace_the_sets(tmp_path):
    path = tmp_path / "steel.toml"
    path.write_text("bulk_modulus = 160e9\npoisson_ratio = 0.3\n")
    specimen, _ = prepared("linear_elastic", path, {"poisson_ratio": 0.25}, SHEAR)
    assert specimen.parameters == (160e9, 0.25)
    assert "steel.toml" in specimen.source


@pytest.mark.parametrize(
    ("parameters", "assignments", "message"),
    [
        ("papr", {}, "no parameter set 'papr'; did you mean 'paper'"),
        ("absent.toml", {}, "parameter file absent.toml cannot be read"),
        (None, {"static_frction": 1.0}, "has 'static_frction'; did you mean 'static_friction'"),
        (None, {"time_stp": 1.0}, "did you mean 'time_step'"),
        (
            None,
            {"time_step": -1.0},
            r"constant-pressure-shear.time_step = -1.0 is out of bounds; allowed: \(0, inf\) s",
        ),
        (None, {"static_friction": -1.0}, "mu_i_lc.static_friction = -1.0 is out of bounds"),
    ],
)
def test_wrong_request_is_refused(parameters, assignments, message):
    with pytest.raises(InputError, match=message):
        prepared("mu_i_lc", parameters, assignments, SHEAR)


@pytest.mark.parametrize("time_step", [1e-12, 5e-324])
def test_unreasonable_number_of_steps_is_refused(time_step):
    specimen, settings = prepared("mu_i_lc", None, {"time_step": time_step}, SHEAR)
    with pytest.raises(InputError, match="steps; allowed: 1 to"):
        run_element_test(SHEAR, specimen, settings)


def test_stated_density_is_taken():
    test = get_element_test("isotropic")
    specimen, settings = prepared("modified_cam_clay", None, {"density": 1500.0, "time_step": 0.1}, test)
    assert run_element_test(test, specimen, settings).density[0] == 1500.0


def test_table_has_names_units_and_every_kept_state(tmp_path):
    test = get_element_test("oedometer")
    result = run_element_test(test, *prepared("modified_cam_clay", None, {"time_step": 0.1}, test))
    path = tmp_path / "oedometer.csv"
    result.write_csv(path)
    header, *rows = csv.reader(path.open())
    assert header[:2] == ["time [s]", "stress_xx [Pa]"]
    assert header[-2:] == ["preconsolidation_pressure [Pa]", "opening_strain [1]"]
    values = np.array(rows, dtype=float)
    assert np.array_equal(values[:, header.index("pressure [Pa]")], result.pressure)
    assert values.shape == (len(result.points), len(header))
    assert [file.name for file in tmp_path.iterdir()] == ["oedometer.csv"]
