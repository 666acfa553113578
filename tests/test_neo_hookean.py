"""Neo-Hookean elasticity against its closed form, on one point and in the stress pass of the core."""

import math

import numpy as np
import pytest
from scenes_for_tests import BLOCK, changed, simulation

from grainlaw.materials import SymmetricTensor, get_material, isotropic, pressure

LAW = get_material("neo_hookean")
PARAMETERS = LAW.parameters(bulk_modulus=8e5, poisson_ratio=0.3)
SHEAR = 1.5 * 0.4 / 1.3 * 8e5
LAME = 8e5 - 2.0 / 3.0 * SHEAR
DENSITY = 1000.0


def stretched(logarithmic_strain, steps):
    """The stress after stretching along x, at constant rate."""
    stress, density = isotropic(0.0), DENSITY
    state = LAW.initial_state(stress, density, PARAMETERS)
    rate = SymmetricTensor(logarithmic_strain, 0.0, 0.0, 0.0, 0.0, 0.0)
    for _ in range(steps):
        density *= math.exp(-logarithmic_strain / steps)
        stress, state = LAW.update(stress, rate, density, state, PARAMETERS, 1.0 / steps)
    return stress


@pytest.mark.parametrize("logarithmic_strain", [0.7, -0.5])
def test_uniaxial_stretch_to_second_order(logarithmic_strain):
    volume_ratio = math.exp(logarithmic_strain)
    exact = (SHEAR * (volume_ratio**2 - 1.0) + LAME * logarithmic_strain) / volume_ratio
    errors = [abs(stretched(logarithmic_strain, steps).xx - exact) / abs(exact) for steps in (50, 100)]
    assert errors[1] < 1e-4
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert stretched(logarithmic_strain, 100).yy == pytest.approx(LAME * logarithmic_strain / volume_ratio, rel=1e-9)


@pytest.mark.parametrize("stress", [isotropic(-3e5), isotropic(2e5), SymmetricTensor(2e5, -1e5, 0.0, 1e5, 3e4, -2e4)])
def test_initial_state_belongs_to_the_stress(stress):
    """A step without strain keeps the stress, and det b = J^2."""
    state = LAW.initial_state(stress, DENSITY, PARAMETERS)
    new, _ = LAW.update(stress, isotropic(0.0), DENSITY, state, PARAMETERS, 1e-3)
    assert new == pytest.approx(stress, rel=1e-9, abs=1e-4)
    ratio = state.volume_ratio
    b = np.diag([1.0 - LAME / SHEAR * math.log(ratio)] * 3)
    b += (
        ratio
        / SHEAR
        * np.array(
            [[stress.xx, stress.xy, stress.xz], [stress.xy, stress.yy, stress.yz], [stress.xz, stress.yz, stress.zz]]
        )
    )
    assert np.linalg.det(b) == pytest.approx(ratio**2, rel=1e-9)


@pytest.mark.parametrize("poisson_ratio", [-0.97, -0.7, 0.0, 0.49])
@pytest.mark.parametrize("share", [1e-6, 1e-3, 0.005])
def test_neo_hookean_state_under_pressure_is_the_one_next_to_no_strain(poisson_ratio, share):
    """There are others, far from it, where Poisson's ratio is so low that the Lame constant is negative."""
    parameters = LAW.parameters(bulk_modulus=8e5, poisson_ratio=poisson_ratio)
    stress = isotropic(-share * 8e5)
    state = LAW.initial_state(stress, 1000.0, parameters)
    assert state.volume_ratio == pytest.approx(1.0 - share, abs=60.0 * share**2)
    kept, _ = LAW.update(stress, isotropic(0.0), 1000.0, state, parameters, 1.0)
    assert pressure(kept) == pytest.approx(share * 8e5, rel=1e-7)
    less = LAW.update(stress, isotropic(1e-7), 1000.0 * (1.0 - 3e-7), state, parameters, 1.0)[0]
    assert pressure(less) < share * 8e5


def test_neo_hookean_without_a_state_under_pressure_is_no_number():
    state = LAW.initial_state(isotropic(-1e5), 1000.0, LAW.parameters(bulk_modulus=8e5, poisson_ratio=-0.97))
    assert np.isnan(state.volume_ratio)


def test_simple_shear_in_the_stress_pass():
    """F = 1 + kappa e_x (x) e_y: sigma_xy = G kappa and sigma_xx = G kappa^2; nothing of it is linear."""
    content = changed(BLOCK, {"material": {"neo_hookean": PARAMETERS._asdict()}, "body.0.material": "neo_hookean"})
    body = simulation(content).bodies[0]
    kappa, steps = 2.0, 4000
    body.velocity_gradient = np.array([[[0.0], [kappa]], [[0.0], [0.0]]])
    for _ in range(steps):
        body.update_stress(1.0 / steps)
    stresses = body.stress[:, 0]
    assert stresses == pytest.approx([SHEAR * kappa**2, 0.0, 0.0, SHEAR * kappa], rel=2e-3, abs=2e-3 * SHEAR)
