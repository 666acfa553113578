"""The return map for small steps against the bracketed one, which solves the same equations."""

import math

import numpy as np
import pytest
from cam_clay_states import random_deviator, random_strain

from grainlaw.materials import SymmetricTensor
from grainlaw.materials.registry import get_material
from grainlaw.plugins.cam_clay.return_map import CamClay, cam_clay_step
from grainlaw.plugins.cam_clay.small_step import cam_clay_small_step

CONSTANTS = CamClay(1.2, 0.04, 0.008, 0.2)


def random_step(rng, size):
    """Pressure, deviator on or inside the yield surface, strain increments of a size, and p_c."""
    p = 10.0 ** rng.uniform(0.5, 5.0)
    preconsolidation_pressure = p * 10.0 ** rng.uniform(0.0, 1.5)
    q = 1.2 * math.sqrt(p * (preconsolidation_pressure - p)) * rng.choice([1.0, rng.uniform()])
    s = random_deviator(rng, q)
    compression, shear = random_strain(rng, size)
    return p, s, compression, shear, preconsolidation_pressure


@pytest.mark.parametrize(("size", "share"), [(1e-6, 1.0), (1e-5, 1.0), (1e-4, 0.98), (1e-3, 0.2)])
def test_small_steps_end_where_the_bracketed_return_ends(size, share):
    rng = np.random.default_rng(1)
    succeeded, yielded = 0, 0
    for _ in range(1000):
        step = random_step(rng, size)
        small = cam_clay_small_step(*step, CONSTANTS)
        whole = cam_clay_step(*step, CONSTANTS, 0.0)
        yielded += whole.plastic_shear > 0.0
        if small.succeeded:
            succeeded += 1
            scale = whole.mean_pressure + whole.preconsolidation_pressure
            found = np.array([small.mean_pressure, small.preconsolidation_pressure, *small.deviator])
            wanted = np.array([whole.mean_pressure, whole.preconsolidation_pressure, *whole.deviator])
            np.testing.assert_allclose(found, wanted, rtol=0.0, atol=1e-10 * scale)
    assert succeeded >= share * 1000
    assert yielded >= 200


def test_what_is_not_small_is_left_to_the_bracketed_return():
    rng = np.random.default_rng(2)
    assert sum(cam_clay_small_step(*random_step(rng, 0.05), CONSTANTS).succeeded for _ in range(500)) < 5


def test_open_points_and_points_that_open_are_left_to_the_update():
    law = get_material("modified_cam_clay")
    parameters = law.parameter_sets["paper"].parameters
    apart = SymmetricTensor(1.0, 1.0, 0.0, 0.0, 0.0, 0.0)
    for pressure_before, opening_strain in ((0.0, 0.1), (0.0, 0.0), (1.0, 0.0), (1.5, 0.0)):
        stress = SymmetricTensor(*[-pressure_before] * 3, 0.0, 0.0, 0.0)
        state = law.state(1e3, opening_strain)
        assert not law.small_step(stress, apart, 1500.0, state, parameters, 0.01)[2]
