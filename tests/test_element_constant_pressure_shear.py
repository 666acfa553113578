"""The paper's constant-pressure shear test, at full length: 600 000 steps for each material."""

import math

import numpy as np
import pytest

from grainlaw.materials.element.catalogue import get_element_test
from grainlaw.materials.element.lines import compression_lines
from grainlaw.materials.element.run import run_element_test
from grainlaw.materials.element.specimen import prepared
from grainlaw.plugins.mu_i.friction import friction_of_inertial_number

END_OF_STAGE_1 = 2.0


def constant_pressure_shear(law, parameter_set=None, **assignments):
    test = get_element_test("constant-pressure-shear")
    return run_element_test(test, *prepared(law, parameter_set, assignments, test))


def stress_ratio(result):
    return result.deviatoric_stress / result.pressure


def at(result, time):
    return int(np.argmin(np.abs(result.time - time)))


def steady_friction(law, inertial_number, **assignments):
    """tau/p after 0.5 s at one inertial number."""
    stage = {"slow_inertial_number": inertial_number, "fast_inertial_number": inertial_number}
    times = {"slow_duration": 0.25, "ramp_duration": 0.125, "fast_duration": 0.125}
    return stress_ratio(constant_pressure_shear(law, **stage, **times, **assignments))[-1] / math.sqrt(3.0)


@pytest.mark.parametrize("inertial_number", [0.001, 0.01, 0.1, 0.3])
def test_friction_of_mu_i_lc_is_mu_of_i(inertial_number):
    expected = friction_of_inertial_number(inertial_number, 1.2 / math.sqrt(3.0), 2.16 / math.sqrt(3.0), 0.279)
    assert steady_friction("mu_i_lc", inertial_number) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("inertial_number", [0.001, 0.1])
def test_viscous_law_is_mu_of_i_without_regularisation(inertial_number):
    expected = friction_of_inertial_number(inertial_number, 1.2 / math.sqrt(3.0), 2.16 / math.sqrt(3.0), 0.279)
    exact = steady_friction("mu_i_lc_viscous", inertial_number, regularisation_rate=0.0)
    assert exact == pytest.approx(expected, rel=1e-12)


def test_regularisation_lowers_slow_friction_as_the_equation_says():
    """alpha = 1e-4 1/s takes (alpha/gamma_dot)^2/2 of the static friction: 2e-7 of mu_0 at I = 0.001."""
    rate = 0.001 * math.sqrt(1000.0 / 2450.0) / 0.005
    exact = steady_friction("mu_i_lc_viscous", 0.001, regularisation_rate=0.0)
    lost = exact - steady_friction("mu_i_lc_viscous", 0.001)
    assert lost == pytest.approx(1.2 / math.sqrt(3.0) * 0.5 * (1e-4 / rate) ** 2, rel=1e-3)


def test_mu_i_lc_with_table_1_and_with_the_parameters_of_the_published_figure():
    table_1 = stress_ratio(constant_pressure_shear("mu_i_lc"))
    assert table_1[-1] == pytest.approx(1.453, abs=1e-3)
    published = stress_ratio(constant_pressure_shear("mu_i_lc", "published_figure"))
    assert published[-1] == pytest.approx(2.00, abs=5e-3)


def test_volume_of_mu_i_lc_stays():
    result = constant_pressure_shear("mu_i_lc")
    assert np.ptp(result.log_specific_volume) < 1e-12


@pytest.fixture(scope="module", params=["paper", "paper_ocr4"])
def cam_clay(request):
    return constant_pressure_shear("modified_cam_clay", request.param)


def test_cam_clay_reaches_critical_state_in_stage_1(cam_clay):
    assert stress_ratio(cam_clay)[at(cam_clay, END_OF_STAGE_1)] == pytest.approx(1.2, rel=1e-3)


def test_cam_clay_ends_on_the_critical_state_line(cam_clay):
    on_line = compression_lines(cam_clay).critical_state(cam_clay.pressure[-1])
    assert cam_clay.log_specific_volume[-1] == pytest.approx(on_line, abs=1e-3)


def test_cam_clay_volume_change_has_the_sign_of_its_packing(cam_clay):
    change = cam_clay.log_specific_volume[-1] - cam_clay.log_specific_volume[0]
    if cam_clay.specimen.parameters.overconsolidation_ratio == 1.0:
        assert change < -0.02
        assert np.max(stress_ratio(cam_clay)) <= 1.2 * (1.0 + 1e-6)
    else:
        assert change > 0.02
        assert np.max(stress_ratio(cam_clay)) > 1.5


def test_pressure_is_held_and_density_follows_the_volume(cam_clay):
    assert np.max(np.abs(cam_clay.pressure - 1000.0)) <= 1e-6
    volume_strain = np.sum(cam_clay.strain[:, :3], axis=1)
    assert np.allclose(np.log(cam_clay.density[0] / cam_clay.density), volume_strain, rtol=0.0, atol=1e-10)


def test_rates_follow_the_inertial_number(cam_clay):
    unit_rate = math.sqrt(1000.0 / 2450.0) / 0.005
    for time, inertial_number in ((1.0, 0.001), (3.0, 0.0505), (5.0, 0.1)):
        rate = cam_clay.shear_strain_rate[at(cam_clay, time)]
        assert rate == pytest.approx(inertial_number * unit_rate, rel=1e-9)
