"""The closed solutions that cases compare with, against known values and one another."""

import math

import numpy as np
import pytest

from grainlaw.validation.cases.exact.bagnold_incline import HEIGHT, exact_velocity, inertial_number
from grainlaw.validation.cases.exact.elastic_bar_vibration import frequency
from grainlaw.validation.cases.exact.generalised_vortex import history, largest
from grainlaw.validation.cases.exact.rigid_rotation import START, turned_stress
from grainlaw.validation.cases.exact.sliding_block import exact_distance
from grainlaw.validation.cases.point.cam_clay_solutions import EXAMPLE
from grainlaw.validation.cases.spaces import driven_cylinder, pipe_flow, turned_block, vibrations


def test_golden_states_of_the_worked_example():
    assert EXAMPLE.drained_state(0.1) == pytest.approx((272.288e3, 0.07547), rel=1e-4)
    assert EXAMPLE.drained_failure() == pytest.approx(400e3)
    assert EXAMPLE.undrained_state(0.02) == pytest.approx((137.620e3, 127.454e3), rel=1e-5)
    assert EXAMPLE.undrained_pressure(1.2) == pytest.approx(114.870e3, rel=1e-5)
    assert EXAMPLE.earth_pressure_at_rest() == pytest.approx(0.64763, rel=1e-5)


def test_one_dimensional_path_ends_at_rest():
    p, q = EXAMPLE.one_dimensional_state(0.6)
    assert q / p == pytest.approx(EXAMPLE.stress_ratio_at_rest(), rel=1e-8)


def test_undrained_path_starts_elastically():
    """Without plastic shear at eta = 0 the first slope is 3 G."""
    _, q = EXAMPLE.undrained_state(1e-8)
    shear_modulus = EXAMPLE.shear_ratio * EXAMPLE.initial_pressure / EXAMPLE.swelling_index
    assert q == pytest.approx(3.0 * shear_modulus * 1e-8, rel=1e-3)


def test_bagnold_flow_of_glass_beads():
    assert inertial_number() == pytest.approx(0.0891, rel=1e-3)
    assert exact_velocity(HEIGHT) == pytest.approx(0.7793, rel=1e-4)
    assert exact_velocity(0.0) == 0.0


def test_sliding_block_after_half_a_second():
    assert exact_distance(0.5) == pytest.approx(0.29454, rel=1e-4)


def test_frequency_of_a_sampled_cosine():
    times = np.linspace(0.0, 10.0, 401)
    assert frequency(times, np.cos(2.0 * math.pi * 0.93 * times)) == pytest.approx(0.93, rel=1e-4)


def test_a_turned_stress_keeps_its_invariants():
    values, start = turned_stress(0.7), START
    assert sum(values[:3]) == pytest.approx(sum(start[:3]))
    assert values[0] * values[1] - values[3] ** 2 == pytest.approx(start[0] * start[1] - start[3] ** 2)


def test_the_vortex_follows_its_exact_motion_with_the_body_force_of_the_right_sign():
    errors = [largest(history(cells)) for cells in (6, 10)]
    assert errors[1] < 0.08
    assert errors[0] > 2.0 * errors[1]
    assert largest(history(6, shear_sign=-1.0)) > 0.5


def test_pipe_flow_starts_from_rest_and_ends_as_a_parabola():
    radii = np.linspace(0.0, 1.0, 11)
    largest = pipe_flow.DENSITY * pipe_flow.ACCELERATION / (4.0 * pipe_flow.VISCOSITY)
    assert pipe_flow.exact_velocity(radii, 1e3) == pytest.approx(largest * (1.0 - radii**2))
    assert np.abs(pipe_flow.exact_velocity(radii, 0.0)).max() < 1e-2 * largest
    # of a short time, as of a body in free fall
    assert pipe_flow.exact_velocity(0.0, 0.05) == pytest.approx(pipe_flow.ACCELERATION * 0.05, rel=1e-3)


def test_radial_mode_leaves_the_rim_without_stress():
    k, shear = vibrations.exact_wave_number(), 1e5 * 3.0 * (1.0 - 0.6) / (2.0 * 1.3)
    step = 1e-6
    inner, rim, outer = vibrations.j1(k * np.array([1.0 - step, 1.0, 1.0 + step]))
    stretch = (outer - inner) / (2.0 * step)
    assert (1e5 + 4.0 / 3.0 * shear) * stretch + (1e5 - 2.0 / 3.0 * shear) * rim == pytest.approx(0.0, abs=1.0)


def test_force_on_the_driven_cylinder_balances_its_stress_and_inertia():
    """By differences of the first Piola-Kirchhoff stress of the deformation, and of the displacement in time."""
    place, time, step = np.array([[0.3], [0.7]]), 3e-3, 1e-5

    def piola(places):
        f = driven_cylinder.stretches(places, time)
        logarithm = np.log(f.radial * f.around * f.up)
        return [
            driven_cylinder.SHEAR_MODULUS * (stretch - 1.0 / stretch) + driven_cylinder.LAME * logarithm / stretch
            for stretch in f
        ]

    def slope(axis, component):
        way = np.zeros((2, 1))
        way[axis] = step
        return (piola(place + way)[component] - piola(place - way)[component]) / (2.0 * step)

    moments = [driven_cylinder.displacement(place, time + shift) for shift in (-step, 0.0, step)]
    inertia = (moments[0] - 2.0 * moments[1] + moments[2]) / step**2
    radial, around, _ = piola(place)
    divergence = np.array([slope(0, 0) + (radial - around) / place[0], slope(1, 2)])
    expected = inertia - divergence / driven_cylinder.DENSITY
    assert driven_cylinder.body_force(place, time) == pytest.approx(expected, rel=1e-3)


def test_gradient_of_a_turning_block_is_that_of_its_rotation():
    turning, step = turned_block.Turning(precession=0.7), 1e-5
    change = (turning.rotation(0.4 + step) - turning.rotation(0.4 - step)) / (2.0 * step)
    assert turning.gradient(0.4) == pytest.approx(change @ turning.rotation(0.4).T, abs=1e-9)
