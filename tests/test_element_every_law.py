"""Every law passes every element test with every of its parameter sets; a held stress and the jumps of a law."""

import math
from dataclasses import replace

import numpy as np
import pytest

from grainlaw.materials import SimulationError, SymmetricTensor, get_material, registry
from grainlaw.materials.element.catalogue import ELEMENT_TESTS, get_element_test
from grainlaw.materials.element.run import run_element_test
from grainlaw.materials.element.search import is_shut, narrowed, search_from
from grainlaw.materials.element.specimen import Specimen, prepared

SETS = [(name, chosen) for name in sorted(registry().laws) for chosen in get_material(name).parameter_sets]
# The strain is the default one, in a tenth of the steps.
FEWER_STEPS = {"constant-pressure-shear": 1e-4}
HELD = {
    "constant-pressure-shear": lambda result: result.pressure,
    "triaxial-drained": lambda result: -0.5 * (result.stress[:, 0] + result.stress[:, 2]),
    "biaxial": lambda result: -result.stress[:, 0],
}
LARGEST_JUMP = 1e-6
P0 = 500.0


def history(test, law, parameter_set=None, **assignments):
    chosen = get_element_test(test)
    return run_element_test(chosen, *prepared(law, parameter_set, assignments, chosen))


@pytest.mark.parametrize(("law", "parameter_set"), SETS)
def test_every_law_passes_every_test(law, parameter_set):
    for test in ELEMENT_TESTS:
        result = history(test, law, parameter_set, time_step=FEWER_STEPS.get(test, 1e-2))
        assert np.isfinite(result.stress).all()
        if test in HELD:
            assert HELD[test](result) == pytest.approx(result.settings.initial_pressure, rel=LARGEST_JUMP)


@pytest.mark.parametrize("parameter_set", ["paper", "paper_ocr4"])
@pytest.mark.parametrize(("test", "critical"), [("triaxial-drained", 1.2), ("biaxial", None)])
def test_unified_law_takes_all_default_steps(test, parameter_set, critical):
    result = history(test, "mu_i_mcc", parameter_set)
    assert result.steps == 30_000
    assert HELD[test](result) == pytest.approx(100e3, rel=LARGEST_JUMP)
    if critical:
        assert result.deviatoric_stress[-1] / result.pressure[-1] == pytest.approx(critical, rel=1e-3)


def jumping(size):
    """Elastic, with stresses in the middle of cells of a size [Pa], as if an iteration came no nearer."""

    def update(stress, strain_rate, density, state, parameters, dt):
        bulk, modulus = 1000.0 / 1.2, 1000.0 / 2.6
        volume = (strain_rate.xx + strain_rate.yy + strain_rate.zz) * dt
        pressure_change = (bulk - 2.0 / 3.0 * modulus) * volume
        xx = stress.xx + pressure_change + 2.0 * modulus * strain_rate.xx * dt
        yy = stress.yy + pressure_change + 2.0 * modulus * strain_rate.yy * dt
        zz = stress.zz + pressure_change + 2.0 * modulus * strain_rate.zz * dt
        xx = size * (math.floor(xx / size) + 0.5)
        zz = size * (math.floor(zz / size) + 0.5)
        return SymmetricTensor(xx, yy, zz, 0.0, 0.0, 0.0), state

    law = replace(get_material("linear_elastic"), name="jumping", update=update)
    return Specimen(law, law.parameter_sets["soft_solid"].parameters, "jumping", "made up")


@pytest.mark.parametrize("test", ["triaxial-drained", "biaxial"])
def test_stress_is_held_to_a_jump_of_the_law_that_is_small_enough(test):
    chosen = get_element_test(test)
    result = run_element_test(chosen, jumping(1e-6 * P0), chosen.settings(initial_pressure=P0, final_strain=0.02))
    off = np.abs(HELD[test](result)[1:] / P0 - 1.0)
    assert off == pytest.approx(0.5e-6, rel=1e-3)


def test_stress_over_which_the_law_jumps_in_earnest_is_not_held():
    chosen = get_element_test("triaxial-drained")
    with pytest.raises(SimulationError, match=r"jumping: the radial stress cannot be held in step 1 "):
        run_element_test(chosen, jumping(1e-3 * P0), chosen.settings(initial_pressure=P0))


@pytest.mark.parametrize("slope", [0.0, 1e12])
def test_search_shuts_around_a_jump(slope):
    search = search_from(0.0, slope, 1.0)
    for _ in range(200):
        if is_shut(search, 1.0):
            break
        search = narrowed(search, -1.0 if search.x < 3.0 else 0.5)
    assert search.lower < 3.0 <= search.upper
    assert search.upper - search.lower < 1e-14
