"""`grainlaw validate` from the command line."""

import json

import pytest
from scenes_for_tests import call_command_line

from grainlaw.validation import catalogue
from grainlaw.validation.case import Effort
from grainlaw.validation.cases.hard.ranges import CASES as RANGES
from grainlaw.validation.result import run_case

# The cases that run one material point, fast enough for every test run.
POINT_CASES = (
    "simple_shear",
    "mcc_triaxial_drained",
    "mcc_triaxial_undrained",
    "mcc_one_dimensional_compression",
    "opening_and_closing",
)
SMALL_SCENES = (
    "rigid_rotation",
    "elastic_bar_vibration",
    "axis_aligned_solution",
    "sliding_block",
    "leaving_the_domain",
    "floor_friction_range",
    "turned_scene",
    "contact_gap",
)


@pytest.mark.parametrize("name", [*POINT_CASES, *SMALL_SCENES])
def test_case_passes_and_its_control_fails(name):
    result = run_case(catalogue.get_case(name), Effort.QUICK)
    assert result.reasons == ()
    assert result.control_fails


# Of the ranges that are not run above; all of their values would take longer.
@pytest.mark.parametrize("name", sorted(RANGES.keys() - {*SMALL_SCENES}))
def test_the_control_of_a_range_fails_its_own_claim(name):
    control = RANGES[name].control(Effort.QUICK)
    assert not any("not reached" in found.name for found in control)
    assert any(not found.within_band for found in control)


def test_no_two_hard_cases_share_a_control():
    mistakes = [catalogue.get_case(name).mistake for name in catalogue.SUITES["hard"]]
    assert sorted(set(mistakes)) == sorted(mistakes)


@pytest.mark.parametrize("name", catalogue.NAMES)
def test_every_case_declares_what_it_proves(name):
    case = catalogue.get_case(name)
    assert case.name == name
    assert all((case.title, case.proves, case.reference, case.norm, case.mistake))


def test_two_cases_with_a_report(monkeypatch, tmp_path, capsys):
    arguments = ("validate", "simple_shear", "opening_and_closing", "--quick", "--out", tmp_path / "report")
    assert call_command_line(monkeypatch, *arguments) == 0
    assert "2 of 2 cases pass" in capsys.readouterr().out
    results = json.loads((tmp_path / "report" / "results.json").read_text(encoding="utf-8"))
    assert [case["name"] for case in results["cases"]] == ["simple_shear", "opening_and_closing"]
    assert results["passed"] is True
    assert {path.name for path in (tmp_path / "report").iterdir()} == {"results.json", "junit.xml", "report.html"}


def test_a_failing_case_is_exit_code_1(monkeypatch, capsys):
    monkeypatch.setattr("grainlaw.validation.cases.point.opening_and_closing.BAND", 0.0)
    assert call_command_line(monkeypatch, "validate", "opening_and_closing", "--quick") == 1
    assert "0 of 1 cases pass" in capsys.readouterr().out


def test_an_unknown_case_is_one_line_with_the_nearest_name(monkeypatch, capsys):
    assert call_command_line(monkeypatch, "validate", "simple_shaer") == 2
    assert (
        capsys.readouterr().err
        == "error: unknown validation case or suite 'simple_shaer'; did you mean 'simple_shear'?\n"
    )


def test_a_folder_that_cannot_be_made_is_refused_before_anything_runs(monkeypatch, tmp_path, capsys):
    file = tmp_path / "file"
    file.write_text("")
    assert call_command_line(monkeypatch, "validate", "simple_shear", "--out", file) == 2
    assert "simple_shear ..." not in capsys.readouterr().err


def test_a_suite_stands_for_its_cases_each_once():
    chosen = [case.name for case in catalogue.chosen_cases(["simple_shear", "standard"])]
    assert chosen[0] == "simple_shear"
    assert sorted(chosen) == sorted(catalogue.SUITES["standard"])
    assert chosen == [case.name for case in catalogue.chosen_cases([])]


def test_list_names_every_case(monkeypatch, capsys):
    assert call_command_line(monkeypatch, "validate", "--list") == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in catalogue.NAMES)
