"""Files of parameters: draws have the covariance of the fit, and what is wrong in a file is said in one line."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from calibration_data import exact, planned

from grainlaw.materials import InputError, get_material
from grainlaw.materials.calibration.findings import Findings
from grainlaw.materials.calibration.fit import fit_to_data
from grainlaw.materials.calibration.parameter_file import parameter_file, read_calibrated
from grainlaw.materials.element.specimen import base_values
from grainlaw.studies.draws import drawn

LAW = get_material("mu_i_lc")
VALUES = LAW.parameter_sets["paper"].parameters._asdict() | {
    "static_friction": 0.5,
    "dynamic_friction": 0.9,
    "inertial_number_constant": 0.25,
}
FITTED = ("static_friction", "dynamic_friction", "inertial_number_constant")
TABLE = """
[calibration]
law = "mu_i_lc"
sources = ["by hand"]
drawn = ["static_friction", "inertial_number_constant"]
logarithmic = [false, true]
covariance = [[1e-4, 2e-4], [2e-4, 1e-2]]
"""


def written(path: Path, table: str = TABLE, **changes: float) -> Path:
    """A file of parameters with a table that was never fitted."""
    values = "\n".join(f"{name} = {value!r}" for name, value in {**VALUES, **changes}.items())
    path.write_text(values + table)
    return path


@pytest.fixture
def path(tmp_path):
    return tmp_path / "parameters.toml"


@pytest.mark.parametrize("largest_number", [1.0, 0.02])
def test_file_holds_the_covariance_of_what_is_determined(path, largest_number):
    """Where friction does not level off, mu_d and I_0 are not determined and are held: mu_0 is alone."""
    numbers = np.geomspace(1e-3, largest_number, 9)
    test = planned("steady-shear", "inertial_number", numbers, {"friction": 5e-3}, strain_to_steady=0.4)
    found = Findings(fit_to_data(LAW, exact(LAW, [test], VALUES), FITTED, VALUES))
    path.write_text(parameter_file(found))
    table, scales = read_calibrated(path).table, [at.scale for at in found.fit.coordinates[:2]]
    if largest_number == 1.0:
        assert (table.drawn, table.logarithmic, table.held) == ([*FITTED], [False, False, True], [])
        units = np.array([*scales, 1.0])
        assert np.array(table.covariance) == pytest.approx(found.covariance * np.outer(units, units), rel=1e-9)
    else:
        assert (table.drawn, table.held) == (["static_friction"], ["dynamic_friction", "inertial_number_constant"])
        alone = Findings(fit_to_data(LAW, exact(LAW, [test], VALUES), FITTED[:1], VALUES))
        assert table.covariance[0][0] == pytest.approx(alone.covariance[0, 0] * scales[0] ** 2, rel=1e-3)
    assert base_values(LAW, path)[0] == found.fit.values


def test_draws_have_the_covariance_of_the_file(path):
    values = drawn(read_calibrated(written(path)), 4000, seed=1).values
    u = np.array([[one["static_friction"], np.log(one["inertial_number_constant"])] for one in values])
    covariance = np.array([[1e-4, 2e-4], [2e-4, 1e-2]])
    errors = np.sqrt(np.diag(covariance))
    assert (u.mean(axis=0) - [0.5, np.log(0.25)]) / errors == pytest.approx(0.0, abs=4.0 / np.sqrt(4000))
    assert np.cov(u.T) / np.outer(errors, errors) == pytest.approx(covariance / np.outer(errors, errors), abs=0.1)
    assert {one["dynamic_friction"] for one in values} == {0.9}


def test_scatter_that_told_the_errors_gives_draws_of_student(path):
    """Beyond two standard deviations lie 4.6 % of the normal, 13.9 % of Student's distribution with 3 degrees."""
    values = drawn(read_calibrated(written(path, TABLE + "degrees_of_freedom = 3")), 4000, seed=1).values
    beyond = np.mean([abs(one["static_friction"] - 0.5) > 0.02 for one in values])
    assert beyond == pytest.approx(0.139, abs=0.02)


def test_draws_repeat_and_more_of_them_begin_with_the_same(path):
    calibrated = read_calibrated(written(path))
    few = drawn(calibrated, 5, seed=3)
    assert drawn(calibrated, 8, seed=3).values[:5] == few.values
    assert drawn(calibrated, 5, seed=4).values != few.values


def test_draws_that_the_law_refuses_are_made_again_and_counted(path):
    """Half of a normal distribution about the friction at speed lies beyond it."""
    draws = drawn(read_calibrated(written(path, dynamic_friction=0.5)), 400, seed=0)
    assert all(values["static_friction"] <= 0.5 for values in draws.values)
    assert 300 < draws.refused < 520


def test_estimates_beyond_reach_of_the_law_are_refused(path):
    calibrated = read_calibrated(written(path))
    at_bound = replace(calibrated, values=calibrated.values | {"static_friction": 0.99})
    with pytest.raises(InputError, match="lie at their bounds"):
        drawn(at_bound, 3, seed=0)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[calibration]", "[calibrations]", "has no table [calibration], from which draws are made"),
        ("drawn = ", "dran = ", "[calibration]: unknown key 'dran'; did you mean 'drawn'?"),
        ('law = "mu_i_lc"', 'law = "mu_lc"', "did you mean 'mu_i_lc'?"),
        ('"static_friction", "in', '"static_frction", "in', "did you mean 'static_friction'?"),
        ("[[1e-4", "[[-1e-4", "negative variance"),
        ("2e-4", "2e-2", "negative variance"),
        ("[[1e-4, 2e-4]", "[[1e-4, 1e-4]", "covariance is not symmetric"),
        ("[[1e-4, ", "[[", "covariance must have 2 rows of 2 numbers, as many as drawn names"),
        ("[[1e-4", '[["a"', "covariance.0.0 = 'a': allowed: a number"),
        ("[false, ", "[", "logarithmic has 1 entries, drawn has 2"),
        ("[false, ", "[1, ", "logarithmic.0 = 1: allowed: true or false"),
        ("drawn = [", "degrees_of_freedom = 0\ndrawn = [", "degrees_of_freedom = 0: allowed: > 0"),
        ("bulk_modulus = ", "bulk_modulus = -", "allowed: (0, inf)"),
        ("static_friction = 0.5", "static_friction = ", "cannot be read"),
    ],
)
def test_what_is_wrong_in_the_file_is_one_line(path, old, new, message):
    text = written(path).read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(InputError) as raised:
        read_calibrated(path)
    assert str(path) in str(raised.value)
    assert message in str(raised.value)
    assert "\n" not in str(raised.value)
