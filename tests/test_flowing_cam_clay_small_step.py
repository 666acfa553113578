"""The return map of mu(I)-MCC for small steps against the bracketed one, which solves the same equations."""

import math

import numpy as np
import pytest
from cam_clay_states import random_deviator, random_strain

from grainlaw.materials import SymmetricTensor, half_norm
from grainlaw.materials.registry import get_material
from grainlaw.plugins.cam_clay.rate_dependent import FlowingCamClay, growth_of_surface, steady_stress_ratio
from grainlaw.plugins.cam_clay.rate_dependent_return_map import flowing_cam_clay_step
from grainlaw.plugins.cam_clay.rate_dependent_small_step import flowing_cam_clay_small_step

CONSTANTS = FlowingCamClay(1.2, 2.16, 0.279, 2.36, 0.04, 0.008, 0.2, 2450.0, 0.005)


def random_step(rng, size, change=1.0):
    """A state on or inside the surface of some I, a strain of a size, and a time over which I changes by a factor."""
    p, number = 10.0 ** rng.uniform(0.5, 5.0), 10.0 ** rng.uniform(-6.0, 0.0)
    p_c = p * 10.0 ** rng.uniform(0.0, 1.5)
    q = steady_stress_ratio(number, CONSTANTS) * math.sqrt(p * (p_c - p)) * rng.choice([1.0, rng.uniform()])
    s = random_deviator(rng, q)
    compression, shear = random_strain(rng, size)
    dt = half_norm(shear) * CONSTANTS.grain_diameter * math.sqrt(CONSTANTS.grain_density / p) / (number * change)
    return p, s, compression, shear, p_c / growth_of_surface(number, CONSTANTS), number, dt


@pytest.mark.parametrize(("size", "share"), [(1e-6, 0.9), (1e-5, 0.9), (1e-4, 0.9), (1e-3, 0.15)])
def test_small_steps_end_where_the_bracketed_step_ends(size, share):
    rng = np.random.default_rng(1)
    succeeded, flowing = 0, 0
    for _ in range(1000):
        step = random_step(rng, size)
        small = flowing_cam_clay_small_step(*step, CONSTANTS)
        whole = flowing_cam_clay_step(*step, CONSTANTS)
        flowing += whole.inertial_number > 1e-3
        if small.succeeded:
            succeeded += 1
            growth = growth_of_surface(whole.inertial_number, CONSTANTS)
            scale = whole.mean_pressure + whole.size_at_rest * growth
            found = np.array([small.mean_pressure, small.size_at_rest * growth, *small.deviator])
            wanted = np.array([whole.mean_pressure, whole.size_at_rest * growth, *whole.deviator])
            np.testing.assert_allclose(found, wanted, rtol=0.0, atol=1e-8 * scale)
            assert small.inertial_number == pytest.approx(whole.inertial_number, rel=1e-6, abs=1e-8)
            p_c = growth_of_surface(small.inertial_number, CONSTANTS) * small.size_at_rest
            assert small.ratio * small.mean_pressure == pytest.approx(p_c, rel=1e-12)
    assert succeeded >= share * 1000
    assert flowing >= 200


def test_a_jump_of_the_shear_rate_is_met_or_left_to_the_bracketed_step():
    rng = np.random.default_rng(3)
    succeeded = 0
    for _ in range(1000):
        step = random_step(rng, 1e-5, change=10.0 ** rng.uniform(-2.0, 2.0))
        small = flowing_cam_clay_small_step(*step, CONSTANTS)
        if small.succeeded:
            succeeded += 1
            whole = flowing_cam_clay_step(*step, CONSTANTS)
            assert small.inertial_number == pytest.approx(whole.inertial_number, rel=1e-6, abs=1e-8)
    assert succeeded >= 500


def test_what_is_not_small_is_left_to_the_bracketed_step():
    rng = np.random.default_rng(2)
    assert sum(flowing_cam_clay_small_step(*random_step(rng, 0.05), CONSTANTS).succeeded for _ in range(500)) < 5


def test_a_number_beyond_the_power_series_is_left_to_the_bracketed_step():
    p, s, compression, shear, size, _, dt = random_step(np.random.default_rng(4), 1e-6)
    assert not flowing_cam_clay_small_step(p, s, compression, shear, 1e-30 * size, 5.0, dt, CONSTANTS).succeeded


def test_open_points_and_points_that_open_are_left_to_the_update():
    law = get_material("mu_i_mcc")
    parameters = law.parameter_sets["paper"].parameters
    apart = SymmetricTensor(1.0, 1.0, 0.0, 0.0, 0.0, 0.0)
    for pressure_before, opening_strain in ((0.0, 0.1), (0.0, 0.0), (1.0, 0.0), (1.5, 0.0)):
        stress = SymmetricTensor(*[-pressure_before] * 3, 0.0, 0.0, 0.0)
        state = law.state(1e3, opening_strain, 0.0)
        assert not law.small_step(stress, apart, 1500.0, state, parameters, 0.01)[2]
