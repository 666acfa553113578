"""Calibration: true values come back, intervals cover them as often as they say, and what is undetermined is named."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from calibration_data import exact, planned, with_noise
from scipy.stats import binom

from grainlaw import materials
from grainlaw.materials import InputError, get_material
from grainlaw.materials.calibration.findings import Findings
from grainlaw.materials.calibration.fit import calibrate, fit_to_data
from grainlaw.materials.calibration.told_by import told_by
from grainlaw.plugins.mu_i.friction import friction_of_inertial_number
from grainlaw.validation.cases.point.cam_clay_solutions import EXAMPLE

SHEAR_DATA = Path(materials.__file__).parent / "calibration" / "data" / "plane_shear_liggghts.csv"
TRIALS = 200

CLAY = get_material("modified_cam_clay")
CLAY_VALUES = CLAY.parameter_sets["paper"].parameters._asdict() | {
    "critical_state_ratio": 1.1,
    "compression_index": 0.1,
    "swelling_index": 0.02,
    "poisson_ratio": 0.25,
}
CLAY_START = {"critical_state_ratio": 1.3, "compression_index": 0.06, "swelling_index": 0.01, "poisson_ratio": 0.2}
CLAY_TESTS = [
    planned(
        "triaxial-drained", "axial_strain", np.linspace(0.02, 0.3, 10),
        {"deviatoric_stress": 2e3, "volumetric_strain": 1e-3},
        initial_pressure=1e5, density=1600.0, strain_step=1e-2, overconsolidation_ratio=1.5,
    ),
]  # fmt: skip

FLOW = get_material("mu_i_lc")
FLOW_VALUES = FLOW.parameter_sets["paper"].parameters._asdict() | {
    "static_friction": 0.4,
    "dynamic_friction": 0.7,
    "inertial_number_constant": 0.15,
}
FLOW_START = {"static_friction": 0.5, "dynamic_friction": 0.9, "inertial_number_constant": 0.3}
FLOW_TESTS = [
    planned(
        "steady-shear", "inertial_number", np.geomspace(1e-3, 1.0, 9), {"friction": 5e-3},
        held_normal_stress=1000.0, strain_to_steady=0.4, strain_step=1e-2,
    ),
]  # fmt: skip

SYNTHETIC = {
    "triaxial": (CLAY, CLAY_VALUES, CLAY_START, CLAY_TESTS),
    "shear": (FLOW, FLOW_VALUES, FLOW_START, FLOW_TESTS),
}


def fitted(law, tests, fitted_names, values, start):
    return Findings(fit_to_data(law, tests, list(fitted_names), values | start))


@pytest.mark.parametrize("case", SYNTHETIC)
def test_true_values_come_back_from_data_without_noise(case):
    law, values, start, tests = SYNTHETIC[case]
    found = fitted(law, exact(law, tests, values), start, values, start)
    assert {name: found.fit.values[name] for name in start} == pytest.approx(
        {name: values[name] for name in start}, rel=1e-5
    )
    assert all(estimate.determined for estimate in found.estimates)


@pytest.mark.parametrize("case", SYNTHETIC)
def test_95_percent_intervals_hold_the_true_values_in_95_percent_of_the_trials(case):
    law, values, start, tests = SYNTHETIC[case]
    random = np.random.default_rng(6)
    truth = exact(law, tests, values)
    hits, hits_of_half_the_width = dict.fromkeys(start, 0), dict.fromkeys(start, 0)
    for _ in range(TRIALS):
        found = fitted(law, with_noise(truth, random), start, values, start)
        half_widths = found.quantile * np.sqrt(np.diag(found.covariance))
        for estimate, at, u, half_width in zip(
            found.estimates, found.fit.coordinates, found.fit.solution, half_widths, strict=True
        ):
            true = values[estimate.name]
            hits[estimate.name] += estimate.lower <= true <= estimate.upper
            lower, upper = at.interval(float(u), 0.5 * float(half_width))
            hits_of_half_the_width[estimate.name] += lower <= true <= upper
    # Seven parameters in all: honest intervals fail here for one seed in about a thousand.
    least, most = binom.ppf([0.5e-4, 1.0 - 0.5e-4], TRIALS, 0.95)
    assert {name: count for name, count in hits.items() if not least <= count <= most} == {}
    assert {name: count for name, count in hits_of_half_the_width.items() if count >= least} == {}


def test_unknown_standard_errors_are_estimated_from_the_scatter():
    random = np.random.default_rng(3)
    noisy = with_noise(exact(FLOW, FLOW_TESTS, FLOW_VALUES), random)
    unknown = [
        replace(test, measured=tuple(replace(found, standard_errors=None) for found in test.measured)) for test in noisy
    ]
    known, estimated = (fitted(FLOW, tests, FLOW_START, FLOW_VALUES, FLOW_START) for tests in (noisy, unknown))
    scatter = (known.misfit / known.freedom) ** 0.5
    for one, other in zip(known.estimates, estimated.estimates, strict=True):
        assert one.value == pytest.approx(other.value, rel=1e-3)
    width = [np.sqrt(np.diag(found.covariance)) for found in (known, estimated)]
    assert width[1] == pytest.approx(scatter * width[0], rel=1e-2)
    assert any("without standard errors" in remark for remark in estimated.remarks)


def test_intervals_are_those_of_linear_regression():
    """With I_0 held, mu(I) is linear in its two other constants: the textbook's formula holds exactly."""
    found = Findings(
        calibrate("mu_i_lc", [SHEAR_DATA], ["static_friction", "dynamic_friction"], {"inertial_number_constant": 0.15})
    )
    (friction,) = found.fit.model.data[0].measured
    numbers = 0.5 * found.fit.model.data[0].abscissa
    share = np.array([friction_of_inertial_number(number, 0.0, 1.0, 0.15) for number in numbers])
    matrix = np.array([1.0 - share, share]).T / friction.standard_errors[:, None]
    covariance = np.linalg.inv(matrix.T @ matrix)
    expected = covariance @ matrix.T @ (friction.values / friction.standard_errors)
    for estimate, value, error in zip(found.estimates, expected, np.sqrt(np.diag(covariance)), strict=True):
        assert estimate.value == pytest.approx(value, rel=1e-5)
        assert estimate.upper - estimate.lower == pytest.approx(2.0 * 1.959964 * error, rel=1e-4)
        assert estimate.determined
    correlation = covariance[0, 1] / np.sqrt(covariance[0, 0] * covariance[1, 1])
    assert found.correlation[0, 1] == pytest.approx(correlation, rel=1e-4)


def test_a_file_alone_tells_what_its_rows_say(tmp_path):
    """The slowest shear and the rest: of the linear mu(I), the information of a file is the sum of its own squares."""
    lines = SHEAR_DATA.read_text().splitlines()
    head = [line for line in lines if not line[0].isdigit()]
    rows = [line for line in lines if line[0].isdigit()]
    for name, part in (("fast.csv", rows[:4]), ("slow.csv", rows[4:])):
        (tmp_path / name).write_text("\n".join([*head, *part]) + "\n")
    fit = calibrate(
        "mu_i_lc",
        [tmp_path / "slow.csv", tmp_path / "fast.csv"],
        ["static_friction", "dynamic_friction"],
        {"inertial_number_constant": 0.15},
    )
    found = {(told.name, told.file): told for told in told_by(Findings(fit), fit.model)}
    for data in fit.model.data:
        (friction,) = data.measured
        share = np.array([friction_of_inertial_number(number, 0.0, 1.0, 0.15) for number in 0.5 * data.abscissa])
        half_width = 1.959964 / np.linalg.norm((1.0 - share) / friction.standard_errors)
        told = found["static_friction", data.file]
        assert told.upper - told.lower == pytest.approx(2.0 * half_width, rel=1e-3)
    assert ("dynamic_friction", "slow.csv") not in found
    assert ("dynamic_friction", "fast.csv") in found


def test_dem_shear_gives_the_known_friction_and_says_that_the_rest_is_undetermined():
    held = Findings(
        calibrate("mu_i_lc", [SHEAR_DATA], ["static_friction", "dynamic_friction"], {"inertial_number_constant": 0.15})
    )
    assert [estimate.value for estimate in held.estimates] == pytest.approx([0.492, 0.706], abs=5e-3)
    assert any("solid_fraction" in remark and "takes no part" in remark for remark in held.remarks)
    free = Findings(
        calibrate("mu_i_lc", [SHEAR_DATA], ["static_friction", "dynamic_friction", "inertial_number_constant"])
    )
    assert [estimate.determined for estimate in free.estimates] == [True, False, False]
    assert free.estimates[0].value == pytest.approx(0.492, abs=2e-3)
    said = "\n".join(free.remarks)
    assert "do not determine dynamic_friction" in said
    assert "do not determine inertial_number_constant" in said
    assert "only a combination of dynamic_friction and inertial_number_constant is determined" in said


def test_engineering_numbers_are_halved():
    own = planned("steady-shear", "inertial_number", [0.05], {"friction": 1.0}, strain_to_steady=0.4)
    engineering = replace(own, control="engineering_inertial_number", abscissa=np.array([0.1]))
    one, other = (exact(FLOW, [test], FLOW_VALUES)[0].measured[0].values for test in (own, engineering))
    assert one == pytest.approx(other, rel=1e-12)
    assert one == pytest.approx(friction_of_inertial_number(0.05, 0.4, 0.7, 0.15), rel=1e-9)


def test_strain_may_turn_back():
    """Swelling after compression beyond the first yield: ln v - ln p has the slopes lambda, then kappa."""
    there_and_back = planned(
        "isotropic", "volumetric_strain", [0.05, 0.1, 0.09], {"pressure": 1.0}, density=1600.0,
        overconsolidation_ratio=1.0, strain_step=1e-4,
    )  # fmt: skip
    pressure = exact(CLAY, [there_and_back], CLAY_VALUES)[0].measured[0].values
    assert np.log(pressure[1] / pressure[0]) == pytest.approx(0.05 / 0.1, rel=1e-6)
    assert np.log(pressure[2] / pressure[1]) == pytest.approx(-0.01 / 0.02, rel=1e-6)


def test_undrained_path_is_the_closed_solution():
    values = CLAY_VALUES | {
        "critical_state_ratio": EXAMPLE.critical_state_ratio,
        "compression_index": EXAMPLE.compression_index,
        "swelling_index": EXAMPLE.swelling_index,
        "overconsolidation_ratio": 1.0,
    }
    test = planned(
        "triaxial-undrained", "axial_strain", [0.3, 1.0], {"pressure": 1.0, "deviatoric_stress": 1.0},
        initial_pressure=EXAMPLE.initial_pressure, density=1600.0,
    )  # fmt: skip
    pressure, deviatoric_stress = (found.values for found in exact(CLAY, [test], values)[0].measured)
    assert pressure[-1] == pytest.approx(114.870e3, rel=1e-4)
    assert deviatoric_stress[-1] == pytest.approx(137.844e3, rel=1e-4)


def test_without_names_everything_is_fitted_on_which_the_data_depend():
    tests = exact(FLOW, FLOW_TESTS, FLOW_VALUES)
    found = Findings(fit_to_data(FLOW, tests, [], FLOW_VALUES | FLOW_START))
    assert {estimate.name for estimate in found.estimates} == set(FLOW_START)
    assert "bulk_modulus" in found.fit.without_effect
    assert any("do not depend on grain_density" in remark for remark in found.remarks)


def test_law_that_misses_the_data_is_said_to():
    tests = exact(FLOW, FLOW_TESTS, FLOW_VALUES)
    wrong = tests[0].measured[0].values + np.where(np.arange(9) % 2, 0.05, -0.05)
    tests = [replace(tests[0], measured=(replace(tests[0].measured[0], values=wrong),))]
    found = fitted(FLOW, tests, FLOW_START, FLOW_VALUES, FLOW_START)
    assert any("misses the data by more than their standard errors" in remark for remark in found.remarks)


def test_more_parameters_than_measurements_are_refused():
    test = planned("steady-shear", "inertial_number", [0.01, 0.1], {"friction": 0.01}, strain_to_steady=0.4)
    with pytest.raises(InputError, match="2 measurements cannot determine 3 parameters"):
        fit_to_data(FLOW, exact(FLOW, [test], FLOW_VALUES), list(FLOW_START), FLOW_VALUES)
