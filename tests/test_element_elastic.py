"""Linear elasticity has a closed answer to every element test: E = 1000 Pa, nu = 0.3."""

import math
from dataclasses import replace

import numpy as np
import pytest

from grainlaw.materials import SimulationError, get_material
from grainlaw.materials.element.catalogue import ELEMENT_TESTS, get_element_test
from grainlaw.materials.element.run import run_element_test
from grainlaw.materials.element.search import narrowed, search_from
from grainlaw.materials.element.specimen import Specimen, prepared

YOUNG, NU, P0 = 1000.0, 0.3, 500.0
LAME = YOUNG * NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
SHEAR = YOUNG / (2.0 * (1.0 + NU))
STRAIN = 0.02

STRESS_CHANGES = {
    "simple-shear": [0.0, 0.0, 0.0, 2.0 * SHEAR * STRAIN],
    "isotropic": [-YOUNG / (3.0 * (1.0 - 2.0 * NU)) * STRAIN] * 3 + [0.0],
    "oedometer": [-LAME * STRAIN, -(LAME + 2.0 * SHEAR) * STRAIN, -LAME * STRAIN, 0.0],
    "triaxial-undrained": [SHEAR * STRAIN, -2.0 * SHEAR * STRAIN, SHEAR * STRAIN, 0.0],
    "triaxial-drained": [0.0, -YOUNG * STRAIN, 0.0, 0.0],
    "biaxial": [0.0, -YOUNG / (1.0 - NU * NU) * STRAIN, -NU * YOUNG / (1.0 - NU * NU) * STRAIN, 0.0],
}


def elastic(name, **assignments):
    test = get_element_test(name)
    given = {"initial_pressure": P0, "final_strain": STRAIN, "strain_rate": 0.1, **assignments}
    return run_element_test(test, *prepared("linear_elastic", None, given, test))


@pytest.mark.parametrize("name", STRESS_CHANGES)
def test_final_stress_is_hookes(name):
    result = elastic(name)
    change = result.stress[-1] - result.stress[0]
    assert change == pytest.approx([*STRESS_CHANGES[name], 0.0, 0.0], rel=1e-8, abs=1e-6)


def test_every_test_but_the_papers_is_checked_here():
    assert set(STRESS_CHANGES) | {"constant-pressure-shear"} == set(ELEMENT_TESTS)


def test_lateral_strain_of_the_drained_test_is_poissons():
    result = elastic("triaxial-drained")
    assert result.strain[-1, 0] == pytest.approx(NU * STRAIN, rel=1e-8)


def test_density_of_an_oedometer_follows_the_logarithmic_strain():
    result = elastic("oedometer")
    assert result.density[-1] / result.density[0] == pytest.approx(math.exp(STRAIN), rel=1e-12)


def test_history_keeps_first_and_last_state_and_at_most_a_few_thousand():
    result = elastic("oedometer", time_step=1.7e-5)
    assert len(result.points) <= 3002
    assert result.time[0] == 0.0
    assert result.time[-1] == pytest.approx(result.steps * 1.7e-5)
    assert np.all(np.diff(result.time) > 0.0)


def without_strength(stress, strain_rate, density, state, parameters, dt):
    return 0.0 * stress, state


def test_control_that_cannot_be_met_stops_with_law_and_time():
    law = replace(get_material("linear_elastic"), name="dust", update=without_strength)
    specimen = Specimen(law, law.parameter_sets["soft_solid"].parameters, "dust", "made up")
    test = get_element_test("triaxial-drained")
    with pytest.raises(SimulationError, match=r"dust: the radial stress cannot be held in step 1 \(t = 0.001 s\)"):
        run_element_test(test, specimen, test.settings())


@pytest.mark.parametrize(
    "residual",
    [
        lambda x: x - 3.0,
        lambda x: math.expm1(x) - 5.0,
        lambda x: 1e6 * (x - 0.1) if x > 0.1 else 1e-3 * (x - 0.1),
        lambda x: math.atan(20.0 * (x - 40.0)),
        lambda x: -1.0 if x < 7.0 else x - 7.0,
        lambda x: math.log(x + 0.5) + 0.6 if x > -0.5 else math.nan,
    ],
    ids=["line", "exponential", "kink", "flat far away", "flat below", "undefined below"],
)
@pytest.mark.parametrize("first_slope", [0.0, 1.0, 1e-6])
def test_search_finds_the_root(residual, first_slope):
    search = search_from(0.0, first_slope, 1.0)
    for _ in range(200):
        value = residual(search.x)
        if abs(value) < 1e-12:
            return
        search = narrowed(search, value)
    pytest.fail(f"no root after 200 steps: {search}")
