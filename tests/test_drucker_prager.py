"""Drucker-Prager: Mohr-Coulomb in plane strain, the apex, the return, and what opening costs."""

import math

import numpy as np
import pytest

from grainlaw.materials import (
    SymmetricTensor,
    contraction,
    get_material,
    half_norm,
    isotropic,
    pressure,
    shear_modulus,
    trace,
)
from grainlaw.materials.element.catalogue import get_element_test
from grainlaw.materials.element.run import run_element_test
from grainlaw.materials.element.specimen import prepared
from grainlaw.materials.tensor import deviator

LAW = get_material("drucker_prager")
BARS = LAW.parameter_sets["aluminium_bars"].parameters
ANGLES = [(19.8, 0.0, 0.0), (30.0, 10.0, 2000.0), (35.0, 35.0, 500.0), (40.0, 0.0, 0.0)]


def with_angles(friction, dilatancy, cohesion):
    return BARS._replace(
        friction_angle=math.radians(friction), dilatancy_angle=math.radians(dilatancy), cohesion=cohesion
    )


@pytest.mark.parametrize(("friction", "dilatancy", "cohesion"), ANGLES)
def test_biaxial_test_fails_at_mohr_coulomb_with_the_dilatancy_angle(friction, dilatancy, cohesion):
    values = with_angles(friction, dilatancy, cohesion)._asdict() | {"initial_pressure": 10e3, "final_strain": 1.0}
    test = get_element_test("biaxial")
    result = run_element_test(test, *prepared("drucker_prager", None, values, test))
    largest, smallest = -result.stress[-1, 1], -result.stress[-1, 0]
    strength = (largest + smallest) * math.sin(math.radians(friction))
    strength += 2.0 * cohesion * math.cos(math.radians(friction))
    assert largest - smallest == pytest.approx(strength, rel=1e-6)
    last = result.strain[-1] - result.strain[-2]
    assert (last[0] + last[1]) / (last[0] - last[1]) == pytest.approx(math.sin(math.radians(dilatancy)), abs=1e-5)


def random_steps(count, seed):
    """Stresses in and out of reach of the cone, and strain increments up to 10 %."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        p = 10.0 ** random.uniform(0.0, 6.0)
        raw = SymmetricTensor(*(random.normal(size=6) * p * random.uniform(0.0, 0.3)).tolist())
        increment = SymmetricTensor(*(random.normal(size=6) * 10.0 ** random.uniform(-8.0, -1.0)).tolist())
        yield isotropic(-p) + deviator(raw), increment


@pytest.mark.parametrize(("friction", "dilatancy", "cohesion"), [*ANGLES, (0.0, 0.0, 1000.0)])
def test_no_step_leaves_the_cone_or_gives_out_energy(friction, dilatancy, cohesion):
    parameters = with_angles(friction, dilatancy, cohesion)
    compliance, stiffness = 0.5 / shear_modulus(parameters.bulk_modulus, 0.3), parameters.bulk_modulus
    dilation = math.sin(math.radians(dilatancy)) / math.sqrt(1.0 + math.sin(math.radians(dilatancy)) ** 2 / 3.0)
    n = math.sqrt(1.0 - dilation**2 / 3.0) + dilation * math.sin(math.radians(friction)) / 3.0
    slope, intercept = math.sin(math.radians(friction)) / n, cohesion * math.cos(math.radians(friction)) / n
    for start, increment in random_steps(2000, 3):
        stress, state = LAW.update(
            start, increment, 2650.0, LAW.initial_state(start, 2650.0, parameters), parameters, 1.0
        )
        scale = abs(pressure(stress)) + half_norm(deviator(stress)) + pressure(start) + intercept
        assert half_norm(deviator(stress)) - slope * pressure(stress) - intercept <= 1e-9 * scale
        volume = (pressure(start) - pressure(stress)) / (3.0 * stiffness)
        elastic = compliance * deviator(stress - start) + isotropic(volume)
        plastic = increment - elastic
        assert contraction(stress, plastic) >= -1e-14 * scale * scale / stiffness
        assert state.opening_strain <= max(0.0, trace(plastic)) + 1e-14 * (1.0 + scale / stiffness)


def test_tension_ends_at_the_apex_and_comes_back_where_it_opened():
    parameters = with_angles(30.0, 0.0, 1000.0)
    tension = 1000.0 / math.tan(math.radians(30.0))
    stress, state = isotropic(0.0), LAW.initial_state(isotropic(0.0), 2650.0, parameters)
    opening = isotropic(0.05 / 3.0)
    stress, state = LAW.update(stress, opening, 2650.0, state, parameters, 1.0)
    assert pressure(stress) == pytest.approx(-tension, rel=1e-12)
    assert state.opening_strain == pytest.approx(0.05 - tension / parameters.bulk_modulus, rel=1e-12)
    half_closed, state = LAW.update(stress, -0.5 * opening, 2650.0, state, parameters, 1.0)
    assert half_closed == stress
    stress, state = LAW.update(half_closed, -0.5 * opening, 2650.0, state, parameters, 1.0)
    assert pressure(stress) == pytest.approx(0.0, abs=1e-9 * tension)
    assert state.opening_strain == 0.0


def test_open_grains_carry_no_shear():
    state = LAW.initial_state(isotropic(-100.0), 2650.0, BARS)
    stress, state = LAW.update(isotropic(-100.0), isotropic(0.01), 2650.0, state, BARS, 1.0)
    sheared, _ = LAW.update(stress, SymmetricTensor(0.0, 0.0, 0.0, 0.1, 0.0, 0.0), 2650.0, state, BARS, 1.0)
    assert list(sheared) == [0.0] * 6


@pytest.mark.parametrize("friction", [0.0, 1e-18, 1e-12])
def test_compression_is_carried_however_narrow_the_cone(friction):
    parameters = with_angles(friction, 0.0, 0.0)
    bulk_modulus = parameters.bulk_modulus
    for shear in (0.0, 1e-6, 0.003, 0.1):
        strain = SymmetricTensor(-0.002, -0.001, -0.003, shear, 0.0, 0.0)
        stress, state = LAW.update(
            isotropic(-500.0), strain, 2650.0, LAW.initial_state(isotropic(-500.0), 2650.0, parameters), parameters, 1.0
        )
        assert pressure(stress) == pytest.approx(500.0 + 0.006 * bulk_modulus, rel=1e-12)
        assert half_norm(deviator(stress)) <= 1e-9
        assert state.opening_strain == 0.0


@pytest.mark.parametrize("shear", [0.0, 1e-6, 0.003, 0.1])
def test_fluid_without_friction_and_cohesion_cannot_be_pulled(shear):
    parameters = with_angles(0.0, 0.0, 0.0)
    start = isotropic(-0.001 * parameters.bulk_modulus)
    strain = SymmetricTensor(0.004, 0.0, 0.0, shear, 0.0, 0.0)
    stress, state = LAW.update(start, strain, 2650.0, LAW.initial_state(start, 2650.0, parameters), parameters, 1.0)
    assert list(stress) == [0.0] * 6
    assert state.opening_strain == pytest.approx(0.003, rel=1e-12)
