"""Laws in single precision, and points in it, whose places stay exact."""

from dataclasses import replace

import numpy as np
import pytest
from numba import njit
from scenes_for_tests import BLOCK, CAM_CLAY, COLUMN, changed, simulation
from test_laws_compiled import random_strain_rates, start

from grainlaw.materials import InputError, SymmetricTensor, registry
from grainlaw.materials.compilation import make_single_step, pointwise_law
from grainlaw.materials.precision import PRECISIONS, as_numbers
from grainlaw.materials.single_precision import in_single, nearest_single
from grainlaw.mpm_core.kernels.positions import positions_of
from grainlaw.mpm_core.output.observables import shape_of

LAWS = registry().laws
THAT_HOLD = [name for name, entry in LAWS.items() if entry.law.holds_in_single]
# Of the pressure of the start; one rounding of a density near 1 is 1e-7 of the bulk modulus.
BAND = 2e-4
DT = 1e-4
COLUMN_OF_CLAY = changed(COLUMN, {"material": {"modified_cam_clay": CAM_CLAY}, "body.0.material": "modified_cam_clay"})


def compiled(law, precision):
    step, number = make_single_step(pointwise_law(law, precision)), PRECISIONS[precision]
    return lambda *arguments: step(*(as_numbers(argument, number) for argument in arguments))


def largest_difference(name, steps=400, pressure=1e4):
    """Between single and double precision, over steps from the same random states, over the pressure."""
    law, parameters, stress, density, state = start(name, next(iter(LAWS[name].law.parameter_sets)), pressure)
    exact, rounded = (compiled(law, precision) for precision in PRECISIONS)
    differences = []
    for row in random_strain_rates(steps, 3) * 1e-2 / DT:
        rate = SymmetricTensor(*row.tolist())
        density = float(np.float32(density * np.exp(-DT * (rate.xx + rate.yy + rate.zz))))
        found, _ = rounded(stress, rate, density, state, parameters, DT)
        stress, state = exact(stress, rate, density, state, parameters, DT)
        stress, state = as_numbers(stress, np.float32), as_numbers(state, np.float32)
        stress, state = as_numbers(stress, float), as_numbers(state, float)
        scale = max(pressure, *map(abs, stress))
        differences.append(max(abs(a - b) for a, b in zip(found, stress, strict=True)) / scale)
    return max(differences)


@pytest.mark.parametrize("name", THAT_HOLD)
def test_a_law_that_says_so_holds_in_single_precision(name):
    assert 0.0 < largest_difference(name) < BAND


def test_stiff_grains_under_little_pressure_do_not_hold(monkeypatch):
    usual = LAWS["mu_i_lc"].law.parameter_sets["paper"]
    stiff = replace(usual, parameters=usual.parameters._replace(bulk_modulus=1e9))
    monkeypatch.setitem(LAWS["mu_i_lc"].law.parameter_sets, "paper", stiff)
    assert largest_difference("mu_i_lc", pressure=1e3) > BAND


def test_a_scene_whose_stress_would_be_kept_too_coarsely_is_refused():
    stiff = {"precision": "single", "material.mu_i_lc.bulk_modulus": 5e10}
    with pytest.raises(InputError, match=r"^precision = 'single': the stress of body\.0 \(mu_i_lc\) would be kept to"):
        simulation(COLUMN, stiff)
    simulation(COLUMN, {**stiff, "precision": "double"})
    simulation(COLUMN, {**stiff, "material.mu_i_lc.bulk_modulus": 1e7})


def test_no_number_becomes_zero():
    assert nearest_single(1e-300) > 0.0
    assert nearest_single(0.0) == 0.0
    assert nearest_single(0.1) == np.float32(0.1)


def ratio(a, b):
    return 0.5 * a / max(b, 1e-300)


def test_a_function_in_single_precision_returns_singles():
    adapted = in_single(ratio)

    @njit
    def call(a, b):
        return adapted(a, b)

    assert np.isfinite(call(np.float32(1.0), np.float32(0.0)))
    found = call(np.float32(1.0), np.float32(3.0))
    assert found == float(np.float32(0.5) / np.float32(3.0)) != 0.5 / 3.0


@pytest.mark.parametrize("precision", PRECISIONS)
def test_places_are_kept_to_fourteen_digits(precision):
    body = simulation(BLOCK, {"precision": precision}).bodies[0]
    places = body.positions + np.random.default_rng(1).normal(size=(2, body.count))
    body.positions = places
    np.testing.assert_allclose(positions_of(body.points, body.space), places, rtol=1e-14, atol=1e-14)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_a_point_that_moves_by_less_than_a_single_resolves_moves_all_the_same(precision):
    velocity, dt, steps = 1e-6, 1e-3, 200
    case = simulation(BLOCK, {"precision": precision, "body.0.velocity": [velocity, 0.0]})
    start = case.bodies[0].positions.mean(axis=1)
    assert velocity * dt < 0.1 * np.finfo(np.float32).eps * start[0]
    for _ in range(steps):
        case.step(dt)
    moved = case.bodies[0].positions.mean(axis=1) - start
    assert moved[0] == pytest.approx(velocity * dt * steps, rel=1e-5)


def test_a_pile_in_single_precision_is_that_in_double():
    shapes = []
    for precision in PRECISIONS:
        case = simulation(COLUMN, {"precision": precision})
        case.advance_to(0.5)
        shapes.append(shape_of(case))
    double, single = shapes
    assert single != double
    assert single.runout == pytest.approx(double.runout, rel=1e-3)
    assert single.center_of_mass_height == pytest.approx(double.center_of_mass_height, rel=1e-3)


def test_laws_that_do_not_hold_are_computed_in_double():
    body = simulation(COLUMN_OF_CLAY, {"precision": "single"}).bodies[0]
    assert body.points.dtype == np.float32
    assert not body.law.holds_in_single
    double = simulation(COLUMN_OF_CLAY, {"precision": "double"})
    single = simulation(COLUMN_OF_CLAY, {"precision": "single"})
    for case in (double, single):
        case.advance_to(0.1)
    (exact,), (rounded,) = double.bodies, single.bodies
    pressures = [-body.stress[0][np.argsort(body.ids)] for body in (exact, rounded)]
    np.testing.assert_allclose(pressures[1], pressures[0], rtol=1e-2, atol=1e-4 * pressures[0].max())
