"""`grainlaw run`, `plan` and `compare`: what they print and write, and what they refuse."""

import errno
import os
import re
import subprocess
import sys

import pytest
from scenes_for_tests import (
    BLOCK,
    CAM_CLAY,
    COLUMN,
    FALLING_SPRING,
    call_command_line,
    fresh_registry,
    write_plugin,
    write_scene,
)

from grainlaw.mpm_core.output.run_folder import RunFolder

__all__ = ["fresh_registry"]

QUICK = {"time.end": 0.02, "output": {"pictures": False, "fields": ["velocity"]}}


def test_run_writes_its_folder_says_where_and_leaves_stderr_to_progress(tmp_path, monkeypatch, capsys):
    path = write_scene(tmp_path / "column.toml", COLUMN, {"output.pictures": True, "time.end": 0.2})
    assert call_command_line(monkeypatch, "run", path, "--out", tmp_path / "out", "--threads", 1) == 0
    printed = capsys.readouterr()
    assert all(line.startswith("t = ") for line in printed.err.splitlines())
    assert re.match(
        r"column: t = 0\.2 s, 1536 points, \d+ steps in \S+ s, of which \S+ s to compile or load "
        r"kernels \(\S+ million point-steps/s on 1 thread\)",
        printed.out,
    )
    summary = RunFolder(tmp_path / "out").summary
    assert f"runout {summary.final.runout:.4f} m, height {summary.final.height:.4f} m" in printed.out
    for name in ("run.pvd", "history.csv", "summary.json", "final.png", "history.png", "snapshots.png"):
        assert str(tmp_path / "out" / name) in printed.out
        assert (tmp_path / "out" / name).stat().st_size > 0


def test_the_folder_is_named_after_the_scene_where_none_is_given(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_scene(tmp_path / "small.toml", BLOCK, QUICK)
    assert call_command_line(monkeypatch, "run", "small.toml") == 0
    assert (tmp_path / "runs" / "small" / "summary.json").exists()


def test_the_resolved_scene_in_the_folder_runs_to_the_same_result(tmp_path, monkeypatch):
    path = write_scene(tmp_path / "scene.toml", COLUMN, QUICK)
    first, second = tmp_path / "first", tmp_path / "second"
    arguments = ["--set", "body.0.density=1400", "--set", "grid.cell_size=0.05", "--threads", 1]
    assert call_command_line(monkeypatch, "run", path, "--out", first, *arguments) == 0
    assert call_command_line(monkeypatch, "run", first / "scene.toml", "--out", second, "--threads", 1) == 0
    assert RunFolder(first).summary.points == 6 * 16 * 4
    assert RunFolder(first).summary.final == RunFolder(second).summary.final
    assert (first / "scene.toml").read_text() == (second / "scene.toml").read_text()


def test_a_second_run_into_the_same_folder_needs_overwrite(tmp_path, monkeypatch, capsys):
    path = write_scene(tmp_path / "scene.toml", BLOCK, QUICK)
    out = tmp_path / "out"
    assert call_command_line(monkeypatch, "run", path, "--out", out) == 0
    before = {file.name: file.read_bytes() for file in out.iterdir()}
    capsys.readouterr()
    assert call_command_line(monkeypatch, "run", path, "--out", out, "--set", "time.end=0.03") == 2
    error = capsys.readouterr().err
    assert error == f"error: {out} already holds a run; choose another --out, --resume it or --overwrite it\n"
    assert {file.name: file.read_bytes() for file in out.iterdir()} == before
    assert call_command_line(monkeypatch, "run", path, "--out", out, "--set", "time.end=0.03", "--overwrite") == 0
    assert RunFolder(out).summary.simulated_time == 0.03


def test_an_output_folder_that_cannot_be_is_refused_in_one_line(tmp_path, monkeypatch, capsys):
    path = write_scene(tmp_path / "scene.toml", BLOCK, QUICK)
    for out in (path, path / "below"):
        assert call_command_line(monkeypatch, "run", path, "--out", out) == 2
        error = capsys.readouterr().err
        assert error.startswith(f"error: output folder {out} ")
        assert error.count("\n") == 1


def test_more_threads_than_cores_are_refused(tmp_path, monkeypatch, capsys):
    path = write_scene(tmp_path / "scene.toml", BLOCK, QUICK)
    assert call_command_line(monkeypatch, "run", path, "--out", tmp_path / "out", "--threads", 4096) == 2
    assert re.search(r"threads = 4096: this machine has (\d+); allowed: 1 to \1\n", capsys.readouterr().err)
    assert not (tmp_path / "out").exists()


def test_a_disk_that_is_full_for_any_command_is_one_line(monkeypatch, capsys):
    def full():
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "history.csv")

    monkeypatch.setattr("grainlaw.cli.main.app", full)
    assert call_command_line(monkeypatch, "element") == 1
    assert capsys.readouterr().err == "error: history.csv: No space left on device\n"


PLUGIN_FAULTS = {
    "raises": ({"hook": 'raise RuntimeError("no licence")'}, "RuntimeError: no licence"),
    "syntax": ({"update": "new ="}, "SyntaxError"),
    "no unit": ({"unit": '""'}, "law 'spring': 'stiffness' declares no unit"),
    "name taken": ({"name": "mu_i_lc"}, "law 'mu_i_lc': the name is taken"),
    "does not compile": ({"update": "new.stretch"}, "law 'spring' .* does not compile"),
}


@pytest.mark.parametrize("fault", PLUGIN_FAULTS)
def test_a_faulty_plugin_is_refused_in_one_line(tmp_path, monkeypatch, capsys, fresh_registry, fault):
    changes, message = PLUGIN_FAULTS[fault]
    plugin = write_plugin(tmp_path / f"faulty_{fault.replace(' ', '_')}.py", **changes)
    path = write_scene(tmp_path / "scene.toml", FALLING_SPRING)
    assert call_command_line(monkeypatch, "run", path, "--plugin", plugin, "--out", tmp_path / "out") == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert re.search(message, error)
    assert plugin.name in error
    assert not (tmp_path / "out").exists()


def test_a_plugin_that_is_not_there_is_refused_in_one_line(tmp_path, monkeypatch, capsys):
    path = write_scene(tmp_path / "scene.toml", BLOCK)
    assert call_command_line(monkeypatch, "run", path, "--plugin", tmp_path / "none.py") == 2
    error = capsys.readouterr().err
    assert "none.py" in error
    assert error.count("\n") == 1


def test_a_scene_runs_with_the_law_of_a_plugin(tmp_path, monkeypatch, capsys, fresh_registry):
    path = write_scene(tmp_path / "scene.toml", FALLING_SPRING, {"time.end": 0.05, "body.0.shape.lower": [0.3, 0.3]})
    plugin = write_plugin(tmp_path / "spring.py")
    out = tmp_path / "out"
    assert call_command_line(monkeypatch, "run", path, "--plugin", plugin, "--out", out) == 0
    summary, last = RunFolder(out).summary, RunFolder(out).history[-1]
    assert summary.material == "spring"
    middle = 0.05 - 0.5 * last["dt"]
    assert summary.final.kinetic_energy == pytest.approx(0.5 * 1000.0 * 0.08 * (9.81 * middle) ** 2, rel=1e-3)


def test_plan_says_what_the_run_then_takes(tmp_path, monkeypatch, capsys):
    # So stiff that the speed of the points adds little to that of sound.
    stiff = {"time.end": 0.04, "output.interval": 0.011, "material.mu_i_lc.bulk_modulus": 1e6}
    path = write_scene(tmp_path / "scene.toml", COLUMN, stiff)
    assert call_command_line(monkeypatch, "plan", path, "--threads", 1) == 0
    printed = capsys.readouterr().out
    assert not (tmp_path / "runs").exists()
    assert call_command_line(monkeypatch, "run", path, "--out", tmp_path / "out", "--threads", 1) == 0
    run = RunFolder(tmp_path / "out")
    rows = dict(re.findall(r"│\s*(\S.*?)\s*│\s*(\S.*?)\s*│", printed))
    assert rows["points"] == f"{run.summary.points:,}"
    assert rows["cells of the domain"] == f"{run.summary.cells:,}"
    assert int(rows["steps"].removeprefix("about ")) == pytest.approx(run.summary.steps, rel=0.15)
    assert int(rows["frames"]) == len(run.frame_files) == 5
    assert rows["fields of a frame"] == ", ".join(field.name for field in run.load_frame(0).fields)
    assert "mu_i_lc" in rows["laws"]
    assert "MB" in rows["memory"]
    assert rows["rate"].endswith("million point-steps/s, 1 thread")
    assert re.fullmatch(r"on disk|compiled just now, in \d+ s; a run finds them on disk", rows["kernels"])


@pytest.fixture(scope="module")
def two_runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("compare")
    with pytest.MonkeyPatch.context() as monkeypatch:
        for name, friction in (("smooth", 0.0), ("rough", 0.7)):
            path = write_scene(folder / f"{name}.toml", COLUMN, {"boundary.bottom.coefficient": friction})
            assert call_command_line(monkeypatch, "run", path, "--out", folder / name) == 0
    return folder / "smooth", folder / "rough"


def test_compare_prints_final_states_and_draws_the_snapshots(tmp_path, monkeypatch, capsys, two_runs):
    assert call_command_line(monkeypatch, "compare", *two_runs, "--out", tmp_path / "both") == 0
    printed = capsys.readouterr().out
    for folder in two_runs:
        row = next(line for line in printed.splitlines() if folder.name in line and "mu_i_lc" in line)
        assert f"{RunFolder(folder).summary.final.runout:.4f}" in row
    for name in ("snapshots.png", "history.png"):
        assert (tmp_path / "both" / name).read_bytes().startswith(b"\x89PNG")
        assert str(tmp_path / "both" / name) in printed.replace("\n", "")
    smooth, rough = (RunFolder(folder).summary.final.runout for folder in two_runs)
    assert smooth > rough


def test_compare_refuses_what_is_no_run_and_a_field_that_no_frame_holds(tmp_path, monkeypatch, capsys, two_runs):
    (tmp_path / "empty").mkdir()
    for arguments, message in (
        ([tmp_path / "none"], "run folder .*none does not exist"),
        ([two_runs[0], tmp_path / "empty"], "the run has not finished"),
        ([*two_runs, "--out", tmp_path / "drawn", "--field", "shear_stran"], "did you mean 'shear_strain'"),
    ):
        assert call_command_line(monkeypatch, "compare", *arguments) == 2
        error = capsys.readouterr().err
        assert re.search(message, error)
        assert error.count("\n") == 1
    assert not list((tmp_path / "drawn").glob("*"))


def test_the_installed_command_gives_one_line_and_exit_code_2(tmp_path):
    path = write_scene(tmp_path / "scene.toml", BLOCK, {"grid.cell_size": -1.0})
    command = [sys.executable, "-m", "grainlaw", "run", path, "--out", tmp_path / "out"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    assert re.fullmatch(r"error: .*scene\.toml: grid\.cell_size = -1\.0: .*\n", done.stderr)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--resume", "--overwrite"), "--resume goes on with the run there, --overwrite begins it again; choose one"),
        (("--set", "grid.cell_size=1e-9"), "cells do not fit into memory"),
    ],
)
def test_what_cannot_be_run_is_refused(tmp_path, monkeypatch, capsys, arguments, message):
    path = write_scene(tmp_path / "column.toml", COLUMN, QUICK)
    assert call_command_line(monkeypatch, "run", path, "--out", tmp_path / "out", *arguments) == 2
    assert message in capsys.readouterr().err


def test_a_plan_takes_the_steps_of_a_run(tmp_path, monkeypatch):
    """Forty steps as long as the first would break what stiffens."""
    clay = {"material": {"modified_cam_clay": CAM_CLAY}, "body.0.material": "modified_cam_clay"}
    stressless = {**clay, "body.0.initial_stress": {"kind": "none"}, "grid.cell_size": 0.1, "time.end": 0.1}
    path = write_scene(tmp_path / "column.toml", COLUMN, stressless)
    assert call_command_line(monkeypatch, "plan", path) == 0


@pytest.mark.parametrize("precision", ["double", "single"])
def test_a_second_process_compiles_nothing(tmp_path, monkeypatch, precision):
    path = write_scene(tmp_path / "column.toml", COLUMN, {**QUICK, "precision": precision})
    monkeypatch.setenv("NUMBA_DEBUG_CACHE", "1")
    command = [sys.executable, "-m", "grainlaw", "run", str(path), "--out"]
    _, second = (
        subprocess.run([*command, str(tmp_path / out)], capture_output=True, text=True, check=True).stdout
        for out in ("first", "second")
    )
    assert "data loaded" in second
    assert "data saved" not in second
