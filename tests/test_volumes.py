"""Volumes of points tied to one another: what loose grains take on, and what is left alone."""

import numpy as np
import pytest
from scenes_for_tests import BLOCK, MU_I_LC, set_affine_velocity, simulation

from grainlaw.mpm_core.failures import LARGEST_INCREMENT
from grainlaw.mpm_core.kernels.volume_coupling import (
    closing_strain,
    smoothing_share,
    smoothing_strain,
)

LOOSE = {
    "material": {"mu_i_lc": MU_I_LC},
    "body.0.material": "mu_i_lc",
    "body.0.initial_stress": {"kind": "uniform", "pressure": 100.0},
}
FILLING = {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [1.0, 0.8]}


def pressures(body):
    return -body.stress[:3].mean(axis=0)


def test_nothing_happens_at_rest():
    assert smoothing_share(0.0, 0.01) == 0.0
    assert smoothing_share(5.0, 0.01) == pytest.approx(10.0 / (10.0 + 5.1), rel=1e-12)


def test_pressures_move_towards_the_mean_and_points_only_close():
    assert smoothing_strain(50.0, 100.0, 1e4, 0.1) > 0.0 > smoothing_strain(150.0, 100.0, 1e4, 0.1)
    assert smoothing_strain(100.0, 100.0, 1e4, 0.1) == 0.0
    assert smoothing_strain(1.0, 1e6, 1.0, 1.0) <= 0.1
    assert closing_strain(1400.0, 1500.0, 0.5) == pytest.approx(0.5 * np.log(1500.0 / 1400.0), rel=1e-3)
    assert closing_strain(1500.0, 1400.0, 0.5) == 0.0


def test_the_pressures_of_a_sheared_block_even_out_and_its_volume_stays():
    case = simulation(BLOCK, {**LOOSE, "body.0.shape": FILLING})
    (body,) = case.bodies
    body.density *= 1.0 + 1e-3 * np.random.default_rng(1).normal(size=body.count)
    volume = (body.volume).sum()
    body.velocity_gradient[0, 1] = 1e-6
    body.update_stress(1e-9)
    scatter = pressures(body).std()
    for _ in range(20):
        body.velocity_gradient[0, 1] = 5.0
        body.neighbour_pressure, body.neighbour_density = pressures(body).mean(), 1000.0
        body.update_stress(1e-3, 1e-3)
    assert pressures(body).std() < 0.3 * scatter
    assert (body.volume).sum() == pytest.approx(volume, rel=1e-4)


def test_what_couples_volumes_bounds_no_step():
    """The strain that closes an open point is no motion: the next step has none of it, and no law is to blame."""
    case = simulation(BLOCK, {**LOOSE, "body.0.shape": FILLING})
    (body,) = case.bodies
    shear = 0.1
    set_affine_velocity(body, (0.0, 0.0), [[0.0, shear], [0.0, 0.0]])
    open_point = int(np.argmin(np.hypot(*(body.positions - 0.4))))
    body.density[open_point], body.stress[:, open_point] = 300.0, 0.0
    open_point, dt = body.ids[open_point], 6e-3
    case.step(dt)
    assert body.density[body.ids == open_point] > 300.0 * np.exp(LARGEST_INCREMENT)
    assert case.strain_rate < 1.0
    assert case.adaptive_step() == pytest.approx(case.scene.time.safety * case.critical_time_step())


def test_material_that_carries_tension_is_left_alone():
    results = []
    for mean_pressure, mean_density in ((0.0, 1000.0), (1e3, 1500.0)):
        (body,) = simulation(BLOCK).bodies
        body.velocity_gradient[0, 1] = 5.0
        body.neighbour_pressure, body.neighbour_density = mean_pressure, mean_density
        body.update_stress(1e-3, 1e-3)
        results.append(np.vstack([body.stress, body.density]))
    np.testing.assert_array_equal(*results)
