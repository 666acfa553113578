"""A run that was stopped and goes on leaves the same bits as one that was not."""

import os
import re
import signal
import subprocess
import sys
import time

import h5py
import numpy as np
import pytest
from scenes_for_tests import COLUMN, call_command_line, changed, write_scene

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene, run
from grainlaw.mpm_core.output import recorder
from grainlaw.mpm_core.output.frame_series import read_collection
from grainlaw.mpm_core.output.history import read_history

OUTPUTS = {
    "vtu": {"vtu": True},
    "vtkhdf": {"vtu": False, "vtkhdf": True},
    "both": {"vtu": True, "vtkhdf": True},
}
FINE = {"grid.cell_size": 0.0125, "time.end": 0.6}


def with_output(output, changes=None):
    settings = {"pictures": False, "interval": 0.03, "history_interval": 0.005, **OUTPUTS[output]}
    return changed(COLUMN, {"output": settings, **(changes or {})})


def contents(group):
    """All arrays and attributes of an HDF5 file by name, but for the wall time."""
    found = {}

    def visit(name, item):
        found.update({f"{name}@{key}": np.asarray(value).tobytes() for key, value in item.attrs.items()})
        if isinstance(item, h5py.Dataset):
            found[name] = item[()].tobytes()

    visit("", group)
    group.visititems(visit)
    found.pop("clock@wall_time", None)
    return found


def assert_same_runs(one, other):
    """Everything that the two folders hold is the same, but for wall times."""
    for name in ("checkpoint.h5", "run.vtkhdf"):
        assert (one / name).exists() == (other / name).exists()
        if (one / name).exists():
            with h5py.File(one / name) as first, h5py.File(other / name) as second:
                assert contents(first) == contents(second)
    first, second = read_history(one), read_history(other)
    for name in first.dtype.names:
        if name != "wall_time":
            np.testing.assert_array_equal(first[name], second[name])
    assert (np.diff(second["wall_time"]) >= 0).all()
    assert sorted(path.name for path in one.iterdir()) == sorted(path.name for path in other.iterdir())
    for path in [*one.glob("*.vtu"), *one.glob("*.pvd"), one / "quantities.csv"]:
        assert path.read_bytes() == (other / path.name).read_bytes()


def start(scene_file, out, *options):
    """The command line in a process of its own."""
    command = [sys.executable, "-m", "grainlaw", "run", scene_file, "--out", out, "--threads", "1", *options]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def kill_in_the_middle(process, out, after):
    """SIGKILL the process once its history has passed the time `after` [s]."""
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and process.poll() is None:
        if (out / "history.csv").exists() and (out / "checkpoint.h5").exists():
            history = read_history(out)
            if len(history) and history["t"][-1] > after:
                break
        time.sleep(0.002)
    os.kill(process.pid, signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL


@pytest.mark.parametrize(("output", "precision"), [("vtu", "double"), ("vtu", "single"), ("both", "double")])
def test_a_killed_run_goes_on_to_the_same_bits(tmp_path, monkeypatch, capsys, output, precision):
    scene_file = write_scene(tmp_path / "scene.toml", with_output(output, {**FINE, "precision": precision}))
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    run(Scene.load(scene_file), whole)
    kill_in_the_middle(start(scene_file, killed), killed, after=0.15)
    kill_in_the_middle(start(scene_file, killed, "--resume"), killed, after=0.35)
    assert not (killed / "summary.json").exists()
    assert 0.35 < read_history(killed)["t"][-1] < 0.6
    assert call_command_line(monkeypatch, "run", scene_file, "--out", killed, "--resume", "--threads", 1) == 0
    assert "t = 0.6 s" in capsys.readouterr().out
    assert_same_runs(whole, killed)
    np.testing.assert_allclose([file.time for file in read_collection(killed)], 0.03 * np.arange(21), atol=1e-12)


class StoppedError(Exception):
    """Stands for a process that ends here."""


def stopped_at(monkeypatch, name, call):
    """Let a function that the recorder calls stop the run at a call."""
    original, calls = getattr(recorder, name), []

    def function(*arguments):
        calls.append(name)
        if len(calls) == call:
            raise StoppedError
        return original(*arguments)

    monkeypatch.setattr(recorder, name, function)


@pytest.mark.parametrize(
    ("output", "where"),
    [
        ("vtu", "write_checkpoint"),
        ("vtkhdf", "write_checkpoint"),
        ("vtkhdf", "append_frame"),
        ("both", "write_checkpoint"),
        ("both", "append_frame"),
    ],
)
def test_a_run_that_stopped_between_frame_and_checkpoint_goes_on_to_the_same_bits(tmp_path, monkeypatch, output, where):
    scene = Scene.from_dict(with_output(output))
    whole, stopped = tmp_path / "whole", tmp_path / "stopped"
    run(scene, whole)
    with monkeypatch.context() as context:
        stopped_at(context, where, 4)
        with pytest.raises(StoppedError):
            run(scene, stopped)
    run(scene, stopped, resume=True)
    assert_same_runs(whole, stopped)


def test_a_damaged_vtkhdf_file_is_written_anew_from_the_frames(tmp_path, monkeypatch):
    scene = Scene.from_dict(with_output("both"))
    whole, stopped = tmp_path / "whole", tmp_path / "stopped"
    run(scene, whole)
    with monkeypatch.context() as context:
        stopped_at(context, "append_frame", 4)
        with pytest.raises(StoppedError):
            run(scene, stopped)
    (stopped / "run.vtkhdf").write_bytes((stopped / "run.vtkhdf").read_bytes()[:500])
    run(scene, stopped, resume=True)
    assert_same_runs(whole, stopped)


def test_a_damaged_vtkhdf_file_without_frames_beside_it_is_said_in_one_line(tmp_path, monkeypatch):
    scene = Scene.from_dict(with_output("vtkhdf"))
    with monkeypatch.context() as context:
        stopped_at(context, "append_frame", 4)
        with pytest.raises(StoppedError):
            run(scene, tmp_path)
    (tmp_path / "run.vtkhdf").write_bytes((tmp_path / "run.vtkhdf").read_bytes()[:500])
    with pytest.raises(InputError, match=r"run\.vtkhdf was damaged .* --overwrite starts the run again"):
        run(scene, tmp_path, resume=True)


def test_a_finished_run_may_be_resumed_and_stays_as_it_is(tmp_path):
    scene = Scene.from_dict(with_output("both", {"time.end": 0.05}))
    first = run(scene, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.suffix in (".vtu", ".pvd", ".csv")}
    second = run(scene, tmp_path, resume=True)
    after = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.suffix in (".vtu", ".pvd", ".csv")}
    assert before == after
    assert (first.final, first.steps) == (second.final, second.steps)


def finished(folder):
    return run(Scene.from_dict(with_output("vtu", {"time.end": 0.02})), folder)


@pytest.mark.parametrize(
    ("prepare", "changes", "message"),
    [
        (lambda folder: None, {}, "holds no run to resume"),
        (lambda folder: folder.mkdir(), {}, "holds no run to resume"),
        (lambda folder: folder.write_text("a file"), {}, "holds no run to resume"),
        (finished, {"time.end": 0.03}, "holds a run of another scene than the one to resume"),
        (lambda folder: [finished(folder), (folder / "checkpoint.h5").unlink()], {},
         r"holds no checkpoint\.h5 to resume from; --overwrite starts the run again"),
        (lambda folder: [finished(folder), (folder / "checkpoint.h5").write_bytes(b"rubbish")], {},
         r"checkpoint\.h5 cannot be read"),
    ],
)  # fmt: skip
def test_what_cannot_be_resumed_is_said_in_one_line(tmp_path, monkeypatch, capsys, prepare, changes, message):
    out = tmp_path / "out"
    prepare(out)
    before = {path.name: path.read_bytes() for path in out.iterdir()} if out.is_dir() else {}
    content = with_output("vtu", {"time.end": 0.02, **changes})
    # The same text as in the folder, so that only the change makes it another scene.
    scene_file = tmp_path / "scene.toml"
    scene_file.write_text(Scene.from_dict(content).to_toml())
    assert call_command_line(monkeypatch, "run", scene_file, "--out", out, "--resume") == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert re.search(message, error)
    assert ({path.name: path.read_bytes() for path in out.iterdir()} if out.is_dir() else {}) == before
