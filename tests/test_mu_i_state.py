"""The state-parameter mu(I) law at a point: steady states, limits, energy, and updates that cannot fail."""

import math

import numpy as np
import pytest

from grainlaw.materials import SymmetricTensor, deviator, get_material, half_norm, isotropic, pressure, trace
from grainlaw.plugins import mu_i_state
from grainlaw.plugins.mu_i.consistent_flow import PARTED
from grainlaw.plugins.mu_i.friction import friction_of_inertial_number

LAW = get_material("mu_i_state")
DEM = mu_i_state.DEM
SHEAR = SymmetricTensor(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)
TRIAXIAL = SymmetricTensor(0.5, -1.0, 0.5, 0.0, 0.0, 0.0)


def start(solid_fraction, mean_pressure, parameters=DEM):
    stress, density = isotropic(-mean_pressure), solid_fraction * parameters.grain_density
    return stress, density, LAW.initial_state(stress, density, parameters)


def moved(point, rate, dt, parameters=DEM):
    stress, density, state = point
    density *= math.exp(-trace(rate) * dt)
    stress, state = LAW.update(stress, rate, density, state, parameters, dt)
    return stress, density, state


def held(point, rate, dt, measure, target, parameters=DEM):
    """One step at a volume change such that a measure of the stress stays; secant from the elastic response."""
    stiffness = 2.0 * DEM.stiffness * mu_i_state.elastic_strain_of(target, parameters)
    x, last_x, last_error = 0.0, 1e-9 / dt, None
    for _ in range(50):
        end = moved(point, rate - x / 3.0 * isotropic(1.0), dt, parameters)
        error = measure(end[0]) - target
        if abs(error) <= 1e-10 * target:
            return end
        slope = stiffness * dt if last_error is None else (error - last_error) / (x - last_x)
        last_x, last_error, x = x, error, x - error / slope
    raise AssertionError("the pressure could not be held")


def ratio(point):
    return half_norm(deviator(point[0])) / pressure(point[0])


def friction(number, parameters=DEM):
    constants = parameters.static_friction, parameters.dynamic_friction, parameters.inertial_number_constant
    return friction_of_inertial_number(number, *constants)


def steady_solid_fraction(number, mean_pressure, parameters=DEM):
    z = math.sqrt(mean_pressure / parameters.stiffness)
    packing = max(
        parameters.critical_solid_fraction - parameters.dilation_slope * number, parameters.loosest_solid_fraction
    )
    return packing * (1.0 + parameters.compaction * z) / (1.0 - z)


@pytest.mark.parametrize("number", [1e-5, 1e-3, 0.1, 0.3, 1.0])
def test_steady_shear_at_held_pressure_is_the_closed_form(number):
    """From a dense packing, to 1e-6 in friction and solid fraction."""
    rate = number * math.sqrt(2000.0 / DEM.grain_density) / DEM.grain_diameter
    point = start(0.6, 2000.0)
    for _ in range(800):
        point = held(point, rate * SHEAR, 4e-3 / rate, pressure, 2000.0)
    assert ratio(point) == pytest.approx(friction(number), rel=1e-6)
    assert point[1] / DEM.grain_density == pytest.approx(steady_solid_fraction(number, 2000.0), rel=1e-6)
    assert point[2].inertial_number == pytest.approx(number, rel=1e-6)


@pytest.mark.parametrize("solid_fraction", [0.53, 0.58, 0.62])
def test_drained_compression_from_loose_and_dense_ends_on_one_line(solid_fraction):
    point = start(solid_fraction, 5000.0)
    largest = 0.0
    for _ in range(1500):
        point = held(point, 1e-2 * TRIAXIAL, 0.1, lambda stress: -stress.xx, 5000.0)
        largest = max(largest, ratio(point))
    assert ratio(point) == pytest.approx(DEM.static_friction, rel=1e-3)
    wanted = steady_solid_fraction(0.0, pressure(point[0]))
    assert point[1] / DEM.grain_density == pytest.approx(wanted, rel=1e-3)
    assert (largest > 1.3 * DEM.static_friction) == (solid_fraction > 0.6)


@pytest.mark.parametrize(("solid_fraction", "mean_pressure"), [(0.545, 31e3), (0.56, 3e3), (0.58, 5e3)])
def test_undrained_compression_ends_on_the_same_line(solid_fraction, mean_pressure):
    point = start(solid_fraction, mean_pressure)
    for _ in range(1000):
        point = moved(point, 1e-2 * TRIAXIAL, 0.1)
    assert ratio(point) == pytest.approx(DEM.static_friction, rel=1e-3)
    assert solid_fraction == pytest.approx(steady_solid_fraction(0.0, pressure(point[0])), rel=1e-3)


def test_a_packing_looser_than_the_line_loses_its_pressure_without_drainage():
    point = start(0.53, 5000.0)
    for _ in range(1000):
        point = moved(point, 1e-2 * TRIAXIAL, 0.1)
    assert pressure(point[0]) < 1.0


def test_without_dilatancy_it_is_mu_of_i_at_constant_packing():
    parameters = DEM._replace(dilatancy_coefficient=0.0)
    point = start(0.6, 2000.0, parameters)
    packing = point[2].jamming_solid_fraction
    rate = 0.2 * math.sqrt(2000.0 / DEM.grain_density) / DEM.grain_diameter
    for _ in range(50):
        point = moved(point, rate * SHEAR, 4e-3 / rate, parameters)
    assert point[2].jamming_solid_fraction == pytest.approx(packing, rel=1e-12)
    assert pressure(point[0]) == pytest.approx(2000.0, rel=1e-9)
    assert ratio(point) == pytest.approx(friction(0.2), rel=1e-9)


def test_without_chi_slow_shear_knows_no_rate():
    parameters = DEM._replace(dilation_slope=0.0)
    ends = []
    for rate in (1e-6, 1e-4):
        point = start(0.6, 2000.0, parameters)
        for _ in range(300):
            point = moved(point, rate * SHEAR, 1e-3 / rate, parameters)
        ends.append([*point[0], point[2].jamming_solid_fraction])
    # mu(I) itself differs by (mu_d - mu_0) I/I_0, 1e-6.
    np.testing.assert_allclose(ends[0], ends[1], rtol=1e-5, atol=1e-5 * pressure(point[0]))
    assert pressure(point[0]) > 3000.0


def test_a_looser_packing_settles_to_that_at_rest_and_a_denser_one_stays():
    for solid_fraction in (0.54, 0.56):
        point = start(solid_fraction, 2000.0)
        for _ in range(200):
            point = held(point, isotropic(0.0), 0.01, pressure, 2000.0)
        z = math.sqrt(2000.0 / DEM.stiffness)
        at_rest = DEM.resting_solid_fraction * (1.0 + DEM.compaction * z) / (1.0 - z)
        assert point[1] / DEM.grain_density == pytest.approx(max(solid_fraction, at_rest), rel=1e-4)


def random_points(count, seed):
    """States anywhere up to yield, and increments from 1e-8 to 0.2 at inertial numbers from 1e-6 to 10."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        p, packing = 10.0 ** random.uniform(-2.0, 6.0), random.uniform(0.35, 0.7)
        z = math.sqrt(p / DEM.stiffness)
        direction = deviator(SymmetricTensor(*random.standard_normal(6).tolist()))
        stress = isotropic(-p) + random.uniform(0.0, 0.9) * p / half_norm(direction) * direction
        consolidation = z * 10.0 ** random.choice([0.0, random.uniform(0.0, 2.0)])
        state = LAW.state(packing, consolidation, random.choice([0.0, 10.0 ** random.uniform(-6.0, 1.0)]))
        size, number = 10.0 ** random.uniform(-8.0, -0.7), 10.0 ** random.uniform(-6.0, 1.0)
        strain = deviator(SymmetricTensor(*random.standard_normal(6).tolist()))
        strain = size / half_norm(strain) * strain + size * random.standard_normal() * isotropic(1.0 / 3.0)
        dt = size * DEM.grain_diameter / math.sqrt(p / DEM.grain_density) / number
        yield (stress, packing / (1.0 - z) * DEM.grain_density, state), strain, dt


def energy(point):
    return LAW.stored_energy(*point, DEM)


def work(stress, density, strain):
    xx, yy, zz, xy, yz, xz = (a * b for a, b in zip(stress, strain, strict=True))
    return (xx + yy + zz + 2.0 * (xy + yz + xz)) / density


def test_random_updates_hold_the_equations_and_dissipate():
    """The work of the stress at the end is never less than what is held more; as backward Euler has it."""
    flowing = opened = 0
    for point, strain, dt in random_points(10_000, 1):
        end = moved(point, 1.0 / dt * strain, dt)
        stress, density, state = end
        assert all(math.isfinite(number) for number in (*stress, *state))
        done, held_more = work(stress, density, strain), energy(end) - energy(point)
        assert done - held_more >= -1e-9 * (abs(done) + energy(point) + energy(end))
        p = pressure(stress)
        if p == 0.0:
            opened += 1
            continue
        z, number = mu_i_state.elastic_strain_of(p, DEM), state.inertial_number
        assert abs(1.0 - z - state.jamming_solid_fraction * DEM.grain_density / density) < 1e-14
        steady = steady_solid_fraction(number, p) * (1.0 - z)
        psi = DEM.dilatancy_coefficient * (state.jamming_solid_fraction - steady)
        strength = max(friction(number) + (1.0 - DEM.hidden_dilatancy) * psi, (1.0 + z) * psi, 0.0)
        flowing += number > 0.0
        assert ratio(end) <= strength + 1e-12
        assert number == 0.0 or ratio(end) >= strength - 1e-12
    assert flowing > 5000
    assert opened > 100


def test_elastic_cycles_through_pressure_and_shear_make_no_energy():
    """Around a square in volume and shear, either way; the error is that of the step."""
    for turn in (1.0, -1.0):
        stress, density, state = start(0.6, 5000.0)
        point = stress, density, state._replace(consolidation_strain=0.1)
        before, total, turned_over = energy(point), 0.0, 0.0
        packing = point[2].jamming_solid_fraction
        sides = [isotropic(-1e-3), 2e-3 * SHEAR, isotropic(1e-3), -2e-3 * SHEAR]
        for side in sides if turn > 0.0 else sides[::-1]:
            for _ in range(800):
                strain = 1.0 / 800.0 * side
                last, point = point, moved(point, strain, 1.0)
                done = 0.5 * (work(last[0], last[1], strain) + work(point[0], point[1], strain))
                total, turned_over = total + done, turned_over + abs(done)
        assert point[2].inertial_number == 0.0
        assert point[2].jamming_solid_fraction == pytest.approx(packing, rel=1e-4)
        assert total - (energy(point) - before) == pytest.approx(0.0, abs=3e-3 * turned_over)


def test_the_answer_converges_with_the_step_in_first_order():
    strain = SymmetricTensor(0.002, -0.01, 0.003, 0.02, 0.004, -0.006)
    ends = []
    for steps in (100, 200, 400, 3200):
        point = start(0.6, 5000.0)
        for _ in range(steps):
            point = moved(point, strain, 1.0 / steps)
        ends.append(np.array(point[0]))
    errors = [np.abs(end - ends[-1]).max() for end in ends[:-1]]
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.35)
    assert errors[1] / errors[2] == pytest.approx(2.0, abs=0.35)


def test_grains_part_where_no_inertial_number_takes_up_the_shear():
    """Looser than phi_min, shear compacts faster than any I uses up the trial stress."""
    increment = mu_i_state.Increment(0.39, 1e-6, 0.02, 0.02, 0.0, 0.05, 5000.0, 1e4)
    assert mu_i_state.flow_of_step(increment, 1.0, DEM) == PARTED


def test_open_points_close_where_they_opened():
    point = start(0.58, 3000.0)
    for sign in (1.0, -1.0):
        for _ in range(100):
            point = moved(point, sign * isotropic(5e-4), 1.0)
        if sign > 0.0:
            assert point[0] == isotropic(0.0)
    assert pressure(point[0]) == pytest.approx(3000.0, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "value"),
    [("dynamic_friction", 0.1), ("loosest_solid_fraction", 0.54), ("resting_solid_fraction", 0.5)],
)
def test_contradictions_are_refused(name, value):
    assert name in mu_i_state.inconsistency(DEM._replace(**{name: value}))
    assert mu_i_state.inconsistency(DEM) == ""


def test_a_pressure_that_no_packing_has_is_no_number():
    point = start(0.6, 1.01 * DEM.stiffness)
    assert math.isnan(pressure(moved(point, isotropic(0.0), 1.0)[0]))
