"""Data files of calibration: what they may say, and one clear line for what they may not."""

import numpy as np
import pytest

from grainlaw.materials import InputError, get_material
from grainlaw.materials.calibration.data import read_data
from grainlaw.materials.calibration.experiments import EXPERIMENTS
from grainlaw.materials.calibration.model import ForwardModel, answer
from grainlaw.materials.calibration.quantities import QUANTITIES

LAW = get_material("modified_cam_clay")
HEADER = "axial_strain [1],deviatoric_stress [Pa]"
SOUND = f"# test = triaxial-drained\n{HEADER}\n0.01,1e5\n0.02,2e5\n"


def read(folder, text):
    path = folder / "data.csv"
    path.write_text(text)
    return read_data(path, LAW)


def test_file_is_read_with_its_statements_units_and_gaps(tmp_path):
    (found,) = read(
        tmp_path,
        "\ufeff# Sand, test 7: a remark, with 'quotes\" = nothing\n# test = triaxial-drained,,\n"
        "# initial_pressure = 200e3,,\n"
        "axial_strain,standard_error_deviatoric_stress [Pa],deviatoric_stress [Pa]\n\n0.01,1e3,1e5\n0.02,,\n",
    )
    assert found.experiment.name == "triaxial-drained"
    assert found.statements == {"initial_pressure": 200e3}
    assert found.abscissa.tolist() == [0.01, 0.02]
    (measured,) = found.measured
    assert np.array_equal(measured.values, [1e5, np.nan], equal_nan=True)
    assert measured.standard_errors[0] == 1e3


def test_columns_may_tell_several_tests_apart(tmp_path):
    first, second = read(
        tmp_path,
        "test,initial_pressure,overconsolidation_ratio,axial_strain,deviatoric_stress [Pa]\n"
        "triaxial-drained,1e5,1,0.01,1\ntriaxial-drained,1e5,1,0.02,2\ntriaxial-undrained,2e5,4,0.01,3\n",
    )
    assert [found.experiment.name for found in (first, second)] == ["triaxial-drained", "triaxial-undrained"]
    assert first.abscissa.tolist() == [0.01, 0.02]
    assert second.statements == {"initial_pressure": 2e5, "overconsolidation_ratio": 4.0}
    assert "triaxial-undrained" in second.label


@pytest.mark.parametrize(("nominal", "logarithmic"), [(0.1, -np.log(0.9)), (-0.1, -np.log(1.1))])
def test_nominal_strain_becomes_logarithmic(nominal, logarithmic, tmp_path):
    (found,) = read(tmp_path, SOUND.replace("axial_strain", "nominal_axial_strain"))
    assert found.driven(np.array([nominal])) == pytest.approx([logarithmic])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("# test = triaxial-drained\n", "", r"data.csv: no test; begin the file with '# test = NAME'"),
        ("triaxial-drained", "triaxal-drained", "unknown test 'triaxal-drained'; did you mean 'triaxial-drained'"),
        (
            "\naxial",
            "\n# initial_presure = 1e5\naxial",
            "'initial_presure' is neither a setting of .*'initial_pressure'",
        ),
        ("\naxial", "\n# initial_pressure = 1e5 Pa\naxial", "initial_pressure = 1e5 Pa: '1e5 Pa' is not a number"),
        (
            "deviatoric_stress [Pa]",
            "deviatoric_stress [kPa]",
            r"'deviatoric_stress' has the unit \[kPa\]; allowed: \[Pa\]",
        ),
        ("deviatoric_stress [Pa]", "deviatoric_stress", r"'deviatoric_stress' has no unit; allowed: \[Pa\]"),
        (
            "deviatoric_stress [Pa]",
            "deviatoric_stres [Pa]",
            "unknown column 'deviatoric_stres'; did you mean 'deviatoric_",
        ),
        ("deviatoric_stress [Pa]", "deviatoric stress in Pa", "'deviatoric stress in Pa' is not of the form"),
        ("deviatoric_stress [Pa]", "axial_strain [1]", "two columns are named 'axial_strain'"),
        (
            "deviatoric_stress [Pa]",
            "standard_error_pressure [Pa]",
            "'standard_error_pressure' without a column 'pressure'",
        ),
        ("axial_strain [1]", "pressure [Pa]", "needs one column axial_strain or nominal_axial_strain, not 0"),
        ("0.02,2e5", "0.02,high", "line 4: 'high' is not a number"),
        ("0.02,2e5", "0.02,inf", "line 4: 'inf' is not finite"),
        ("0.02,2e5", "0.02", "line 4: 1 cells under 2 headings"),
        ("0.02,2e5", ",2e5", "line 4: empty cell in axial_strain"),
        ("0.01,1e5\n0.02,2e5\n", "", "no data: expected a header"),
    ],
)
def test_faulty_file_is_refused_in_one_line(old, new, message, tmp_path):
    assert SOUND.count(old) == 1
    with pytest.raises(InputError, match=message) as error:
        read(tmp_path, SOUND.replace(old, new))
    assert "data.csv" in str(error.value)
    assert "\n" not in str(error.value)


def test_standard_error_of_zero_is_refused(tmp_path):
    text = SOUND.replace("stress [Pa]\n", "stress [Pa],standard_error_deviatoric_stress [Pa]\n")
    with pytest.raises(InputError, match="line 3: standard_error_deviatoric_stress must be a number above 0"):
        read(tmp_path, text.replace("1e5\n", "1e5,0\n").replace("2e5\n", "2e5,1\n"))


def test_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"absent\.csv cannot be read"):
        read_data(tmp_path / "absent.csv", LAW)


def test_no_name_means_two_things():
    """A column is a setting or a quantity; what drives one test may be measured in another, but not in the same one."""
    settings = {name for experiment in EXPERIMENTS.values() for name in experiment.settings._fields}
    controls = {name for experiment in EXPERIMENTS.values() for name in experiment.controls}
    assert settings & (controls | set(QUANTITIES)) == set()


HISTORY = (
    "# test = shear-history\n# held_normal_stress = 5e3\n# density = 1350\n"
    "time [s],engineering_shear_strain [1],friction_of_mean_pressure [1]\n"
    "0.1,1,\n0.2,1.1,0.5\n0.3,1.1,\n0.4,0.1,-0.5\n"
)


def test_shear_follows_strains_over_time(tmp_path):
    """Friction of mu(I) at the rate of each row, with its sign: 10, 1, 0 and -10 in the engineering rate."""
    path = tmp_path / "history.csv"
    path.write_text(HISTORY)
    law = get_material("mu_i_lc")
    (data,) = read_data(path, law)
    values = law.parameter_sets["paper"].parameters._asdict()
    result = ForwardModel(law, (data,)).history(data, values, data.abscissa)
    pressures = result.pressure[1:]
    numbers = [
        0.5 * rate * values["grain_diameter"] / np.sqrt(p / values["grain_density"])
        for rate, p in zip((10.0, 1.0, 0.0, 10.0), pressures, strict=True)
    ]
    mu_0, mu_d, constant = (
        values[name] for name in ("static_friction", "dynamic_friction", "inertial_number_constant")
    )
    expected = [mu_0 + (mu_d - mu_0) / (constant / number + 1.0) if number else 0.0 for number in numbers]
    friction = answer(result, data.measured[0])
    assert friction[[0, 1, 3]] == pytest.approx([expected[0], expected[1], -expected[3]], rel=1e-3)
    assert friction[2] == pytest.approx(friction[1], rel=0.02)
    assert result.time.tolist() == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4])


def test_a_history_between_its_rows_is_the_same_history(tmp_path):
    path = tmp_path / "history.csv"
    path.write_text(HISTORY)
    (data,) = read_data(path, LAW)
    assert data.driven(np.array([0.05, 0.15, 0.35])).tolist() == pytest.approx(
        np.array([[0.05, 0.25], [0.15, 0.525], [0.35, 0.3]])
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "engineering_shear_strain",
            "axial_strain",
            "shear-history needs one column engineering_shear_strain or",
        ),
        ("0.3,1.1", "0.2,1.1", "line 7: time must rise from row to row"),
        ("0.1,1,", "0,1,", "line 5: time must rise from row to row, from above 0"),
        ("0.2,1.1", "0.2,", "line 6: empty cell in engineering_shear_strain"),
        ("time [s]", "time [ms]", r"column 'time' has the unit \[ms\]; allowed: \[s\]"),
    ],
)
def test_faults_of_a_history_are_told(old, new, message, tmp_path):
    with pytest.raises(InputError, match=message):
        read(tmp_path, HISTORY.replace(old, new))
