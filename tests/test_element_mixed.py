"""Mixed control: stages of strain rates and stress rates from a TOML file."""

import numpy as np
import pytest

from grainlaw.materials import InputError, SimulationError
from grainlaw.materials.element.catalogue import get_element_test
from grainlaw.materials.element.mixed import mixed_test, read_control
from grainlaw.materials.element.run import run_element_test
from grainlaw.materials.element.specimen import prepared

DRAINED = """
time_step = 0.05
[[stage]]
duration = 5.0
strain_rate = { yy = -0.01 }
stress_rate = { xx = 0.0, zz = 0.0 }
"""


def written(folder, text):
    path = folder / "control.toml"
    path.write_text(text)
    return read_control(path)


def run_mixed(control, law, parameter_set=None, **assignments):
    test = mixed_test(control)
    return run_element_test(test, *prepared(law, parameter_set, assignments, test))


@pytest.mark.parametrize("parameter_set", ["paper", "paper_ocr4"])
def test_two_held_components_make_the_drained_triaxial_test(tmp_path, parameter_set):
    mixed = run_mixed(written(tmp_path, DRAINED), "modified_cam_clay", parameter_set, initial_pressure=200e3)
    test = get_element_test("triaxial-drained")
    settings = {"initial_pressure": 200e3, "final_strain": 0.05, "strain_rate": 0.01, "time_step": 0.05}
    single = run_element_test(test, *prepared("modified_cam_clay", parameter_set, settings, test))
    assert np.allclose(mixed.stress, single.stress, rtol=1e-6, atol=1e-2)
    assert np.allclose(mixed.strain, single.strain, rtol=1e-6, atol=1e-9)


def test_stress_rates_are_followed_and_stages_start_where_the_last_one_ended(tmp_path):
    control = written(
        tmp_path,
        """
        time_step = 0.01
        [[stage]]
        duration = 1.0
        stress_rate = { xx = -50.0, yy = -100.0, zz = 20.0, xy = 10.0 }
        [[stage]]
        duration = 0.5
        strain_rate = { xy = 0.02 }
        stress_rate = { xx = 0.0, yy = 40.0, zz = 0.0 }
        """,
    )
    result = run_mixed(control, "linear_elastic", initial_pressure=500.0)
    shear_stress = 10.0 + 2.0 * 1000.0 / 2.6 * 0.02 * 0.5
    assert result.stress[100, :4] == pytest.approx([-550.0, -600.0, -480.0, 10.0], abs=1e-4)
    assert result.stress[-1] == pytest.approx([-550.0, -580.0, -480.0, shear_stress, 0.0, 0.0], abs=1e-4)
    assert result.time[-1] == pytest.approx(1.5)


def test_stress_beyond_yield_stops_with_component_and_time(tmp_path):
    control = written(
        tmp_path, "time_step = 0.01\n[[stage]]\nduration = 10.0\nstress_rate = { xx = 0.0, yy = -500e3, zz = 0.0 }\n"
    )
    with pytest.raises(
        SimulationError, match=r"modified_cam_clay: stress xx, yy, zz cannot follow its control in step \d+ \(t = "
    ):
        run_mixed(control, "modified_cam_clay", "paper_ocr4", initial_pressure=100e3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time_step = ", "cannot be read"),
        ("time_step = 0.1\nstage = []", "stage = []: allowed: 1 or more entries"),
        ("time_step = -0.1\n[[stage]]\nduration = 1.0", "time_step = -0.1: allowed: > 0"),
        ("time_step = 0.1\n[[stage]]\nduraton = 1.0", "did you mean 'duration'"),
        ("time_stp = 0.1\n[[stage]]\nduration = 1.0", "time_step"),
        ("time_step = 0.1\n[[stage]]\nduration = 1.0\nstrain_rate = { yx = 1.0 }", "'xx', 'yy', 'zz', 'xy', 'yz'"),
        (
            "time_step = 0.1\n[[stage]]\nduration = 1.0\nstrain_rate = { xx = 1.0 }\nstress_rate = { xx = 0.0 }",
            "xx has both a strain rate and a stress rate",
        ),
    ],
)
def test_faulty_control_is_refused_in_one_line(tmp_path, text, message):
    with pytest.raises(InputError) as error:
        written(tmp_path, text)
    assert message in str(error.value)
    assert "control.toml" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("law", ["modified_cam_clay", "mu_i_mcc"])
def test_strain_beyond_the_range_of_numbers_ends_with_the_strain_reached(tmp_path, law):
    control = written(tmp_path, "time_step = 0.02\n[[stage]]\nduration = 2.0\nstrain_rate = { xx = -90.0 }\n")
    with pytest.raises(SimulationError, match=r"stress or density not finite in step \d+ .*strain reached: xx = -\d+"):
        run_mixed(control, law)


def test_extension_until_nothing_is_left_ends_with_the_strain_reached(tmp_path):
    control = written(tmp_path, "time_step = 1.0\n[[stage]]\nduration = 9.0\nstrain_rate = { xx = 150.0, yz = 0.5 }\n")
    with pytest.raises(SimulationError, match=r"in step 5 .*strain reached: xx = 600, yz = 2$"):
        run_mixed(control, "linear_elastic", density=1e-15)


@pytest.mark.parametrize("test", ["isotropic", "oedometer"])
def test_tests_without_control_end_with_the_strain_reached(test):
    chosen = get_element_test(test)
    values = {"final_strain": 60.0, "strain_rate": 1.0, "time_step": 0.5}
    with pytest.raises(SimulationError, match=r"stress or density not finite in step .* strain reached: .*yy = -"):
        run_element_test(chosen, *prepared("modified_cam_clay", None, values, chosen))


def test_held_stress_that_is_lost_names_the_strain_reached():
    chosen = get_element_test("triaxial-drained")
    values = {"final_strain": 900.0, "strain_rate": 1.0, "time_step": 10.0}
    with pytest.raises(SimulationError, match="strain reached: "):
        run_element_test(chosen, *prepared("modified_cam_clay", None, values, chosen))
