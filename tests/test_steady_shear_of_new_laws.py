"""Steady shear at held pressure of two laws that follow mu(I), against their formulas; what the collapse covers."""

import math

import numpy as np
import pytest

from grainlaw.reference.law_pages import own_laws
from grainlaw.validation.cases.collapses.collapse_of_every_law import LAWS
from grainlaw.validation.cases.point.element import element_history

WITHOUT_GRAINS_AT_REST = {"linear_elastic", "neo_hookean", "newtonian", "mu_i_lc_viscous"}


def steady(law, number):
    per_rate = 0.005 / math.sqrt(1000.0 / 2450.0)
    duration = 4.0 / (number / per_rate)
    settings = {"slow_inertial_number": number, "fast_inertial_number": number, "slow_duration": 0.0}
    settings |= {"ramp_duration": 0.5 * duration, "fast_duration": 0.5 * duration, "time_step": duration / 20_000}
    return element_history("constant-pressure-shear", law, "paper", settings)


def friction(number):
    slow, fast = 1.20 / math.sqrt(3.0), 2.16 / math.sqrt(3.0)
    return slow + (fast - slow) * number / (0.279 + number)


@pytest.mark.parametrize("number", [1e-3, 0.1])
@pytest.mark.parametrize("law", ["mu_i_elastoplastic", "mu_i_phi_i"])
def test_shear_stress_over_pressure_is_friction_of_the_inertial_number(law, number):
    result = steady(law, number)
    ratio = result.deviatoric_stress[-1] / math.sqrt(3.0) / result.pressure[-1]
    assert ratio == pytest.approx(friction(number), rel=1e-6)


@pytest.mark.parametrize("number", [1e-3, 0.1])
def test_solid_fraction_falls_with_the_inertial_number(number):
    fraction = np.exp(-steady("mu_i_phi_i", number).log_specific_volume[-1])
    assert fraction == pytest.approx(0.5434 - 0.23 * number, rel=1e-6)


@pytest.mark.parametrize("number", [1e-3, 0.1])
def test_volume_does_not_follow_the_inertial_number_without_dilatancy(number):
    volume = steady("mu_i_elastoplastic", number).log_specific_volume
    assert volume[-1] == pytest.approx(volume[0], abs=1e-9)


def test_the_collapse_of_every_law_leaves_out_no_granular_law():
    assert set(LAWS) | WITHOUT_GRAINS_AT_REST == {law.name for law in own_laws()}
