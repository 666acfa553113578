"""What the stress pass does before the law sees a point: rotation of the stress, change of the density."""

import math
import sys

import numba
import numpy as np
import pytest
from scenes_for_tests import BLOCK, simulation

from grainlaw.mpm_core.kernels.stress_update import INTERNAL_WORK


def one_body(**changes):
    case = simulation(BLOCK, changes)
    return case.bodies[0]


def test_a_rigid_rotation_turns_the_stress_and_keeps_its_invariants():
    body = one_body()
    stress = np.random.default_rng(5).normal(size=(4, body.count)) * 100.0
    body.stress = stress
    turns, steps, spin = 3, 3000, 2.0 * math.pi
    body.velocity_gradient[0, 1], body.velocity_gradient[1, 0] = -spin, spin
    for _ in range(steps):
        body.update_stress(turns / steps)
    xx, yy, zz, xy = body.stress
    np.testing.assert_allclose(xx + yy, stress[0] + stress[1], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(xx * yy - xy**2, stress[0] * stress[1] - stress[3] ** 2, rtol=1e-9, atol=1e-6)
    np.testing.assert_array_equal(zz, stress[2])
    np.testing.assert_array_equal(body.density, 1000.0)
    # Cayley's form lags behind the true angle by its third order, here 3 turns x (2 pi/1000)^2/12.
    np.testing.assert_allclose(body.stress, stress, atol=0.05)


def test_a_quarter_turn_carries_the_vertical_stress_into_the_horizontal_one():
    body = one_body()
    body.stress[[0, 1, 3]] = [[1.0], [-2.0], [0.25]]
    body.velocity_gradient[0, 1], body.velocity_gradient[1, 0] = -1.0, 1.0
    for _ in range(1000):
        body.update_stress(0.5 * math.pi / 1000)
    np.testing.assert_allclose(body.stress[[0, 1, 3], 0], [-2.0, 1.0, -0.25], atol=1e-5)


def test_the_density_follows_the_volume_to_third_order_in_the_step():
    errors = []
    for increment in (0.2, 0.1):
        body = one_body()
        body.velocity_gradient[0, 0], body.velocity_gradient[1, 1] = -0.7, -0.3
        body.update_stress(increment)
        errors.append(abs(body.density[0] / 1000.0 - math.exp(increment)))
    assert errors[1] < 0.1**3
    assert errors[0] / errors[1] == pytest.approx(8.0, rel=0.2)


def test_shear_strain_and_work_of_simple_shear_are_those_of_the_formula():
    body = one_body()
    rate, dt, steps = 0.1, 1e-3, 10
    shear_modulus = 1.5 * (1 - 2 * 0.2) / (1 + 0.2) * 1e4
    body.velocity_gradient[0, 1] = rate
    work = 0.0
    for _ in range(steps):
        body.update_stress(dt)
        work += body.stress_reports[:, INTERNAL_WORK].sum()
    strain = rate * dt * steps
    np.testing.assert_allclose(body.shear_strain, 0.5 * strain, rtol=1e-12)
    np.testing.assert_allclose(body.stress[3], shear_modulus * strain, rtol=1e-5)
    volume = body.count * body.point_mass / 1000.0
    assert work == pytest.approx(0.5 * shear_modulus * strain**2 * volume, rel=1e-5)
    assert body.stress[2].max() == 0.0


def test_shear_strain_is_kept_only_for_a_scene_that_writes_it():
    assert "shear_strain" in one_body().row_names
    body = one_body(**{"output.fields": ["velocity"]})
    assert "shear_strain" not in body.row_names
    assert len(body.points) == len(body.row_names)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems may have no OpenMP")
def test_threads_are_not_those_that_spin_at_the_end_of_a_process():
    one_body().update_stress(1e-4)
    assert numba.threading_layer() == "omp"


def jaumann_error(steps, shear=0.5):
    """Simple shear by `shear` in so many steps against sigma_xy = G sin(gamma), sigma_xx = G (1 - cos(gamma))."""
    (body,) = simulation(BLOCK).bodies
    modulus = 3.0 * 1e4 * (1.0 - 2.0 * 0.2) / (2.0 * (1.0 + 0.2))
    body.velocity_gradient[0, 1] = shear
    for _ in range(steps):
        body.update_stress(1.0 / steps)
    exact = modulus * np.array([1.0 - np.cos(shear), np.sin(shear)])
    return np.abs(body.stress[[0, 3], 0] - exact).max() / modulus


def test_stress_under_shear_and_spin_is_of_second_order_in_the_step():
    errors = [jaumann_error(steps) for steps in (8, 16, 32)]
    assert errors[0] < 1e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.1)
