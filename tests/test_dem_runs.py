"""DEM decks, their runner and the command: one description, clear failures, nothing made twice."""

import pytest
from typer.testing import CliRunner

from grainlaw.cli import app
from materials import InputError, SimulationError
from validation.dem.batch import case_named
from validation.dem.collapse import floor_of
from validation.dem.packing import Packing, cut
from validation.dem.programs import Program, failure, run_program
from validation.dem.runs import Run, inputs_hash, runs_of


def test_both_codes_are_listed():
    answer = CliRunner().invoke(app, ["dem", "list"])
    assert answer.exit_code == 0
    assert "collapse-a2-glued" in answer.output
    assert "shear" in answer.output


def test_unknown_case_names_the_nearest():
    with pytest.raises(InputError, match="did you mean 'collapse-a2-glued'"):
        case_named("collapse-a2-glue")


def test_shear_has_no_yade_deck():
    with pytest.raises(InputError, match="LIGGGHTS only"):
        runs_of(case_named("shear"), "yade")


def test_missing_code_names_its_package(tmp_path):
    absent = Program("LIGGGHTS", "no-such-liggghts", "liggghts", (), "")
    with pytest.raises(InputError, match="install the Debian package 'liggghts'"):
        run_program(absent, tmp_path, "deck.in", 1.0)


def test_time_limit_and_error_lines_are_told(tmp_path):
    sleeper = Program("LIGGGHTS", "sleep", "coreutils", (), "")
    with pytest.raises(SimulationError, match="longer than 1 s"):
        run_program(sleeper, tmp_path, "30", 1.0)
    assert "grains left the box" in failure("Step 1\nERROR: Lost atoms: original 10 current 9 (thermo.cpp:445)\n")
    assert failure("Loop time of 3 on 1 procs\n") == ""


def test_identity_of_a_run_follows_its_physics_only():
    case = case_named("collapse-a2-glued")
    worded = case.model_copy(update={"purpose": "the same in other words", "liggghts_seeds": (9,)})
    stiffer = case.model_copy(update={"contact": case.contact.model_copy(update={"youngs_modulus": 2e8})})
    found = [inputs_hash(Run(one, "liggghts", 1)) for one in (case, worded, stiffer)]
    assert found[0] == found[1] != found[2]
    assert inputs_hash(Run(case, "yade", 1)) != found[0]


def test_glued_floor_lets_no_grain_through():
    case = case_named("collapse-a1-glued")
    glued, plane = floor_of(case, 1)
    assert glued is not None
    assert plane < glued.centres[:, 2].min()
    covered = float((glued.radii**2).sum() * 3.141592653589793) / (2.0 * case.reach * case.depth)
    assert 0.50 < covered < 0.60


def test_cut_keeps_the_volume_below_the_plane():
    import numpy as np

    random = np.random.default_rng(1)
    many = Packing(random.uniform(0.0, 1.0, (40000, 3)), random.uniform(0.006, 0.009, 40000))
    assert cut(many, 0.25).volume / many.volume == pytest.approx(0.25, abs=0.01)
