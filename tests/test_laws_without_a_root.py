"""Laws that iterate: what is not found is no stress, and what is far out of range neither hangs nor passes.

The iterations are cut short by hand in plain Python, which runs the same source as compiled code.
"""

import math

import numpy as np
import pytest

from grainlaw.materials import InputError, SimulationError, SymmetricTensor, get_material, isotropic
from grainlaw.materials.element.catalogue import ELEMENT_TESTS, get_element_test
from grainlaw.materials.element.run import run_element_test
from grainlaw.materials.element.specimen import prepared
from grainlaw.plugins import mu_i_phi_i
from grainlaw.plugins.cam_clay import rate_dependent_return_map
from grainlaw.plugins.mu_i import consistent_flow

START, DENSITY = isotropic(-1000.0), 1500.0


def sheared(law, shear, dt):
    """The stress after one step of simple shear from 1 kPa."""
    parameters = law.parameter_sets["paper"].parameters
    state = law.initial_state(START, DENSITY, parameters)
    strain_rate = SymmetricTensor(0.0, 0.0, 0.0, shear / dt, 0.0, 0.0)
    return law.update(START, strain_rate, DENSITY, state, parameters, dt)[0]


@pytest.mark.parametrize(
    ("name", "module", "iterations"),
    [
        ("mu_i_mcc", rate_dependent_return_map, 1),
        ("mu_i_phi_i", consistent_flow, 2),
        ("mu_i_state", consistent_flow, 2),
    ],
)
@pytest.mark.parametrize("dt", [1e-5, 1e-2])
def test_step_whose_inertial_number_is_not_found_has_no_stress(monkeypatch, name, module, iterations, dt):
    law = get_material(name)
    assert all(math.isfinite(value) for value in sheared(law, 0.01, dt))
    monkeypatch.setattr(module, "MAXIMUM_ITERATIONS", iterations)
    assert math.isnan(sheared(law, 0.01, dt).xx)


def test_inertial_number_is_found_from_a_guess_that_is_twenty_orders_off():
    parameters = mu_i_phi_i.LAW.parameter_sets["paper"].parameters._replace(
        dilation_slope=2.0446357858202306,
        dilatancy_coefficient=336.1672702655276,
        bulk_modulus=223638878.30927998,
        grain_diameter=1.3478165996963075e-05,
    )
    increment = mu_i_phi_i.Increment(
        compression=3.390376060054271e-11,
        solid_fraction=0.7501113947515716,
        trial_shear_stress=0.8034547560638391,
        stiffness=915765655.5787939,
        dt=0.3588713924867237,
    )
    flow = mu_i_phi_i.flow_of_step(increment, 3350255.507527304, parameters)
    assert 1e-15 < flow.number < 1e-14
    assert abs(flow.excess) <= 1e-11 * flow.strength


@pytest.mark.parametrize("shear", [1e150, math.inf])
def test_step_beyond_all_numbers_ends(shear):
    """Parts of such a step are never small."""
    assert math.isnan(sheared(get_material("mu_i_mcc"), shear, 1.0).xx)


@pytest.mark.parametrize("law", ["modified_cam_clay", "mu_i_mcc", "mu_i_phi_i", "neo_hookean"])
@pytest.mark.parametrize("test", sorted(ELEMENT_TESTS))
def test_control_far_out_of_range_ends_with_the_strain_reached_or_with_numbers(test, law):
    chosen = get_element_test(test)
    far = {"final_strain": 1e6, "strain_rate": 1e6, "time_step": 0.01}
    fast = {"slow_inertial_number": 1e6, "fast_inertial_number": 1e9, "ramp_duration": 100.0, "time_step": 1.0}
    settings = fast if test == "constant-pressure-shear" else far
    outcome = outcome_of(chosen, law, settings)
    assert outcome == "finite" or ("strain reached: " in outcome and "\n" not in outcome)


def outcome_of(test, law, settings):
    """What went wrong, or "finite" if all quantities are numbers; without flow there is no viscosity."""
    try:
        result = run_element_test(test, *prepared(law, None, settings, test))
    except SimulationError as error:
        return str(error)
    no_numbers = [column.name for column in result.columns if not np.isfinite(column.values).all()]
    return "finite" if set(no_numbers) <= {"viscosity"} else ", ".join(no_numbers)


@pytest.mark.parametrize("law", ["drucker_prager", "mu_i_elastoplastic"])
def test_pressure_that_no_density_belongs_to_is_refused(law):
    chosen = get_element_test("isotropic")
    with pytest.raises(InputError, match=rf"^{law} has no density at rest under 1e\+12 Pa; set density \[kg/m3\]$"):
        run_element_test(chosen, *prepared(law, None, {"initial_pressure": 1e12}, chosen))


def test_extension_stops_before_the_specific_volume_is_no_number():
    chosen = get_element_test("isotropic")
    settings = {"density": 1.2e-305, "initial_pressure": 1e-6}
    with pytest.raises(SimulationError, match="stress or density not finite in step 1 "):
        run_element_test(chosen, *prepared("linear_elastic", None, settings, chosen))
