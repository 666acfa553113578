"""Modified Cam Clay against its closed solutions: M 1.2, lambda 0.10, kappa 0.02, nu 0.3, p0 200 kPa."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from grainlaw.materials.element.catalogue import get_element_test
from grainlaw.materials.element.run import run_element_test
from grainlaw.materials.element.specimen import prepared

M, LAMBDA, KAPPA, NU, P0 = 1.2, 0.10, 0.02, 0.3, 200e3
SHEAR_RATIO = 1.5 * (1.0 - 2.0 * NU) / (1.0 + NU)
GOLDEN = {
    "critical_state_ratio": M,
    "compression_index": LAMBDA,
    "swelling_index": KAPPA,
    "poisson_ratio": NU,
    "overconsolidation_ratio": 1.0,
    "initial_pressure": P0,
    "strain_rate": 0.01,
}


def element_test(name, **assignments):
    test = get_element_test(name)
    return run_element_test(test, *prepared("modified_cam_clay", None, GOLDEN | assignments, test))


def shear_strain(result):
    """eps_s = 2/3 (eps_axial - eps_radial), compression-positive."""
    return 2.0 / 3.0 * (result.strain[:, 0] - result.strain[:, 1])


def plastic_shear_strain(eta, volumetric_rate):
    """The integral of d(eps_v^p) 2 eta/(M^2 - eta^2), for d(eps_v^p)/d(eta) along the path."""
    return quad(lambda x: volumetric_rate(x) * 2.0 * x / (M * M - x * x), 0.0, eta, epsabs=1e-13, epsrel=1e-13)[0]


def drained_state(strain):
    """Q [Pa] and eps_v of the drained path dq = 3 dp at a shear strain."""

    def volumetric_rate(eta):
        return (LAMBDA - KAPPA) * (1.0 / (3.0 - eta) + 2.0 * eta / (M * M + eta * eta))

    def shear_strain_at(eta):
        elastic = KAPPA / SHEAR_RATIO * math.log(3.0 / (3.0 - eta))
        return plastic_shear_strain(eta, volumetric_rate) + elastic

    eta = brentq(lambda x: shear_strain_at(x) - strain, 0.0, M - 1e-4, xtol=1e-13)
    pressure = 3.0 * P0 / (3.0 - eta)
    volumetric = LAMBDA * math.log(pressure / P0) + (LAMBDA - KAPPA) * math.log((M * M + eta * eta) / (M * M))
    return eta * pressure, volumetric


def undrained_pressure(eta):
    return P0 * (M * M / (M * M + eta * eta)) ** ((LAMBDA - KAPPA) / LAMBDA)


def test_drained_path_passes_the_golden_state_at_a_shear_strain_of_a_tenth():
    result = element_test("triaxial-drained", final_strain=0.15, time_step=2e-3)
    shear, volumetric = (
        np.interp(0.1, shear_strain(result), values) for values in (result.deviatoric_stress, result.volumetric_strain)
    )
    assert shear == pytest.approx(272.288e3, rel=1e-3)
    assert volumetric == pytest.approx(0.07547, rel=1e-3)
    assert (shear, volumetric) == pytest.approx(drained_state(0.1), rel=1e-3)


def test_drained_path_ends_in_the_golden_critical_state():
    result = element_test("triaxial-drained", final_strain=1.5, time_step=5e-3)
    assert result.deviatoric_stress[-1] == pytest.approx(400e3, rel=1e-3)
    assert result.pressure[-1] == pytest.approx(333.33e3, rel=1e-3)
    assert result.volumetric_strain[-1] == pytest.approx(0.10653, rel=1e-3)


def test_radial_stress_is_held_on_the_drained_path():
    result = element_test("triaxial-drained", final_strain=0.3)
    assert np.max(np.abs(result.stress[:, [0, 2]] + P0)) <= 1e-9 * P0


def test_undrained_path_passes_the_golden_states():
    result = element_test("triaxial-undrained", final_strain=0.5, time_step=1e-3)
    strain = shear_strain(result)
    assert np.interp(0.02, strain, result.pressure) == pytest.approx(137.620e3, rel=1e-3)
    assert np.interp(0.02, strain, result.deviatoric_stress) == pytest.approx(127.454e3, rel=1e-3)
    assert result.pressure[-1] == pytest.approx(114.870e3, rel=1e-3)
    assert result.deviatoric_stress[-1] == pytest.approx(137.844e3, rel=1e-3)


def test_undrained_path_follows_its_equation_everywhere():
    """Even in large steps: the law integrates p and p_c exactly, so only the strain along the path has an error."""
    result = element_test("triaxial-undrained", final_strain=0.3, time_step=0.2)
    expected = undrained_pressure(result.deviatoric_stress / result.pressure)
    assert np.allclose(result.pressure, expected, rtol=1e-9)


def test_volume_stays_on_the_undrained_path():
    result = element_test("triaxial-undrained", final_strain=0.3)
    assert np.max(np.abs(result.volumetric_strain)) < 1e-12


def test_coefficient_of_earth_pressure_at_rest():
    result = element_test("oedometer", final_strain=0.5, time_step=2e-3)
    assert result.stress[-1, 0] / result.stress[-1, 1] == pytest.approx(0.64763, rel=1e-3)


def test_isotropic_compression_follows_its_line_exactly():
    result = element_test("isotropic", final_strain=0.2, time_step=0.1)
    assert np.allclose(result.volumetric_strain, LAMBDA * np.log(result.pressure / P0), rtol=1e-9, atol=1e-12)


def convergence_order(errors, ratio):
    return np.log(np.array(errors[:-1]) / np.array(errors[1:])) / math.log(ratio)


def test_drained_path_converges_with_the_step():
    """Error in q against the closed solution at the same shear strain."""
    errors = []
    for step in [0.2, 0.1, 0.05, 0.025]:
        result = element_test("triaxial-drained", final_strain=0.06, time_step=step)
        expected, _ = drained_state(shear_strain(result)[-1])
        errors.append(abs(result.deviatoric_stress[-1] - expected))
    assert np.all(convergence_order(errors, 2.0) > 0.9)


def undrained_shear_strain(eta):
    """eps_s at a stress ratio; d(eps_v^e) = -d(eps_v^p) = kappa dp/p."""

    def volumetric_rate(x):
        return KAPPA * (LAMBDA - KAPPA) / LAMBDA * 2.0 * x / (M * M + x * x)

    def elastic_rate(x):
        return KAPPA / (3.0 * SHEAR_RATIO) * (1.0 - (LAMBDA - KAPPA) / LAMBDA * 2.0 * x * x / (M * M + x * x))

    return plastic_shear_strain(eta, volumetric_rate) + quad(elastic_rate, 0.0, eta)[0]


def test_undrained_path_converges_with_the_step():
    """Error in the shear strain at which the final stress ratio is reached, against the closed solution."""
    errors = []
    for step in [0.1, 0.05, 0.025, 0.0125]:
        result = element_test("triaxial-undrained", final_strain=0.02, time_step=step)
        eta = result.deviatoric_stress[-1] / result.pressure[-1]
        errors.append(abs(shear_strain(result)[-1] - undrained_shear_strain(eta)))
    assert np.all(convergence_order(errors, 2.0) > 0.9)
