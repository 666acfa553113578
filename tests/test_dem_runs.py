"""DEM decks, their runner and the command: one description, clear failures, nothing made twice."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from grainlaw.cli.main import app
from grainlaw.materials import InputError, SimulationError
from grainlaw.mpm_core.space import PLANE_STRAIN
from grainlaw.validation.dem.batch import case_named
from grainlaw.validation.dem.collapse import floor_of
from grainlaw.validation.dem.packing import Packing, cut
from grainlaw.validation.dem.programs import Program, failure, run_program
from grainlaw.validation.dem.runs import Run, inputs_hash, runs_of
from grainlaw.validation.grains.observation import read_observation
from grainlaw.validation.reference.reference_set import REFERENCE


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


# The command itself with `sh` in the place of LIGGGHTS: it starts a process of its own and takes longer than the test.
WITH_A_STAND_IN = """
import sys
from grainlaw.cli.main import main
from grainlaw.validation.dem import programs, runs

stand_in = programs.Program("LIGGGHTS", "sh", "dash", ("-c", "sleep 300 & echo $$ $! > pids; wait"), "")
runs.LIGGGHTS = runs.PROGRAMS["liggghts"] = stand_in
sys.argv = ["grainlaw", "dem", "run", "compression", "--out", sys.argv[1]]
main()
"""


def is_alive(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def waited_for(condition, seconds: float = 60.0):
    end = time.monotonic() + seconds
    while not (found := condition()) and time.monotonic() < end:
        time.sleep(0.05)
    return found


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_the_code_too_and_leaves_the_batch_resumable(tmp_path, number):
    def started() -> list[int]:
        return [int(text) for path in tmp_path.glob("*/*/pids") for text in path.read_text().split()]

    for _ in range(2):
        command = subprocess.Popen(
            [sys.executable, "-c", WITH_A_STAND_IN, str(tmp_path)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        pids = waited_for(started)
        assert len(pids) == 2
        assert all(map(is_alive, pids))
        os.kill(command.pid, number)
        output, errors = command.communicate(timeout=30)
        assert command.returncode == 1
        assert output == ""
        assert errors == (
            f"error: stopped by {number.name}; 0 of 2 runs are finished in {tmp_path}, "
            "the same command goes on with the others\n"
        )
        assert waited_for(lambda ended=pids: not any(map(is_alive, ended)), 10.0)
        assert not list(tmp_path.glob("**/run.json"))
        for path in tmp_path.glob("*/*/pids"):
            path.unlink()


def test_reference_set_is_small_and_shows_stress_of_one_packing_by_each_code():
    runs = {path.stem: read_observation(path) for path in sorted((REFERENCE / "collapse").iterdir())}
    shown = [name.rpartition("_")[0] for name, run in runs.items() if "stress_zz" in run.snapshots]
    assert len(set(shown)) == len(shown)
    columns = {name.partition("_")[0] for name, run in runs.items() if run.space is PLANE_STRAIN}
    assert {name.partition("_")[0] for name in shown} == columns
    assert sum(path.stat().st_size for path in REFERENCE.rglob("*") if path.is_file()) < 8e6
