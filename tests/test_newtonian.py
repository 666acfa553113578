"""The Newtonian fluid on one point."""

import pytest

from grainlaw.materials import SymmetricTensor, get_material, isotropic, pressure

LAW = get_material("newtonian")
GLYCEROL = LAW.parameter_sets["glycerol"].parameters
DENSITY = LAW.parameter_sets["glycerol"].density(1000.0, GLYCEROL)
STATE = LAW.initial_state(isotropic(-1000.0), DENSITY, GLYCEROL)


def test_shear_stress_is_viscosity_times_velocity_gradient():
    gradient = 3.0
    rate = SymmetricTensor(0.0, 0.0, 0.0, 0.5 * gradient, 0.0, 0.0)
    stress, _ = LAW.update(isotropic(-1000.0), rate, DENSITY, STATE, GLYCEROL, 1e-3)
    assert stress.xy == pytest.approx(1.41 * gradient, rel=1e-14)
    assert pressure(stress) == pytest.approx(1000.0, rel=1e-9)


def test_sound_speed_is_the_slope_of_pressure_over_density():
    change = 1e-6 * DENSITY
    after, _ = LAW.update(isotropic(-1000.0), isotropic(0.0), DENSITY + change, STATE, GLYCEROL, 1.0)
    slope = (pressure(after) - 1000.0) / change
    assert LAW.sound_speed(after, DENSITY, STATE, GLYCEROL) ** 2 == pytest.approx(slope, rel=1e-6)


def test_fluid_carries_no_tension():
    stress, _ = LAW.update(isotropic(-1000.0), isotropic(0.1), 0.9 * DENSITY, STATE, GLYCEROL, 1.0)
    assert stress == isotropic(0.0)
