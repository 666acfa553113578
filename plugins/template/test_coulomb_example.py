"""The law on one point: what its three equations say. The third fails until `update` has been completed."""

import pytest

from coulomb_example import LAW
from grainlaw.materials import SymmetricTensor, deviatoric_stress, isotropic, pressure

PARAMETERS = LAW.parameter_sets["sand"].parameters
STRESS = isotropic(-1000.0)
DENSITY = LAW.parameter_sets["sand"].density(1000.0, PARAMETERS)
STATE = LAW.initial_state(STRESS, DENSITY, PARAMETERS)


def sheared(strain):
    """The stress after a simple shear strain eps_xy at constant density, in one step."""
    return LAW.update(STRESS, SymmetricTensor(0.0, 0.0, 0.0, strain, 0.0, 0.0), DENSITY, STATE, PARAMETERS, 1.0)[0]


def test_point_at_rest_keeps_its_stress():
    assert sheared(0.0) == pytest.approx(STRESS, rel=1e-12)


def test_small_shear_is_elastic():
    shear_modulus = 1.5 * (1.0 - 2.0 * 0.2) / (1.0 + 0.2) * 392e3
    assert sheared(1e-4).xy == pytest.approx(2.0 * shear_modulus * 1e-4, rel=1e-12)


def test_large_shear_stays_on_the_yield_surface():
    stress = sheared(0.1)
    assert deviatoric_stress(stress) == pytest.approx(1.2 * pressure(stress), rel=1e-12)


def test_grains_apart_carry_no_stress():
    stress, _ = LAW.update(STRESS, isotropic(0.1), 0.9 * DENSITY, STATE, PARAMETERS, 1.0)
    assert stress == isotropic(0.0)
