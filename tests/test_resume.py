"""A run that was stopped and goes on leaves the same bits as one that was not."""

import contextlib
import errno
import os
import re
import signal
import subprocess
import sys
import time

import h5py
import numpy as np
import pytest
from scenes_for_tests import COLUMN, FALLING_SPRING, call_command_line, changed, grainlaw, write_plugin, write_scene

from grainlaw.materials import InputError
from grainlaw.mpm_core import Scene, run
from grainlaw.mpm_core.output import recorder
from grainlaw.mpm_core.output.checkpoint import how_to_go_on
from grainlaw.mpm_core.output.frame_series import read_collection
from grainlaw.mpm_core.output.history import read_history
from grainlaw.mpm_core.stepping.interrupts import interrupts_noted

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


@pytest.mark.parametrize(("output", "precision"), [("vtu", "double"), ("vtkhdf", "single"), ("both", "double")])
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
    if OUTPUTS[output]["vtu"]:
        times = [file.time for file in read_collection(killed)]
        np.testing.assert_allclose(times, 0.03 * np.arange(21), atol=1e-12)


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


def unfinished(folder):
    """A run as one that was killed before its end leaves it; its checkpoint."""
    finished(folder)
    (folder / "summary.json").unlink()
    return folder / "checkpoint.h5"


@pytest.mark.parametrize(
    ("prepare", "changes", "message"),
    [
        (lambda folder: None, {}, "holds no run to resume"),
        (lambda folder: folder.mkdir(), {}, "holds no run to resume"),
        (lambda folder: folder.write_text("a file"), {}, "holds no run to resume"),
        (finished, {"time.end": 0.01}, r"time\.end = 0\.02 there, 0\.01 here; a time\.end may only be later"),
        (finished, {"grid.cell_size": 0.05, "body.0.density": 1400.0},
         r"another scene .*: grid\.cell_size = 0\.025 there, 0\.05 here; also body\.0\.density = 1500\.0 there, 1400"),
        (finished, {"material.mu_i_lc.bulk_modulus": 3e4, "time.end": 0.04},
         r"resume: material\.mu_i_lc\.bulk_modulus = 20000\.0 there, 30000\.0 here\n"),
        (finished, {"output.interval": 0.01}, r"output\.interval = 0\.03 there, 0\.01 here"),
        (lambda folder: unfinished(folder).unlink(), {},
         r"holds no checkpoint\.h5 to resume from; --overwrite starts the run again"),
        (lambda folder: unfinished(folder).write_bytes(b"rubbish"), {},
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


@pytest.mark.parametrize(
    ("output", "stated", "first_end"),
    [("vtu", True, 0.06), ("both", True, 0.07), ("vtkhdf", False, 0.07)],
    ids=["end on a frame", "end between frames", "intervals by default"],
)
def test_a_longer_run_goes_on_to_the_same_bits_as_one_that_ran_through(tmp_path, output, stated, first_end):
    settings = {"pictures": False, **OUTPUTS[output]}
    intervals = {"interval": 0.03, "history_interval": 0.004} if stated else {}
    # The intervals of the shorter run, which a longer one keeps.
    kept = intervals or {"interval": first_end / 30, "history_interval": first_end / 300}
    through, longer = tmp_path / "through", tmp_path / "longer"
    run(Scene.from_dict(changed(COLUMN, {"time.end": 0.1, "output": settings | kept})), through)
    for end in (first_end, 0.08, 0.1):
        scene = Scene.from_dict(changed(COLUMN, {"time.end": end, "output": settings | intervals}))
        summary = run(scene, longer, resume=longer.exists())
        assert summary.simulated_time == end
        assert read_history(longer)["t"][-1] == end
    assert_same_runs(through, longer)
    assert (through / "scene.toml").read_text() == (longer / "scene.toml").read_text()


def falling_spring(folder, **plugin):
    """What the command line takes to run a law of its own."""
    path = write_scene(folder / "scene.toml", FALLING_SPRING, {"time.end": 0.05})
    law = write_plugin(folder / "springy.py", **plugin)
    return "run", path, "--plugin", law, "--out", folder / "out", "--threads", 1


@pytest.mark.parametrize(("edit", "goes_on"), [({}, True), ({"update": "new = 0.5 * new"}, False)])
def test_a_run_does_not_go_on_with_an_edited_law(tmp_path, edit, goes_on):
    assert grainlaw(*falling_spring(tmp_path)).returncode == 0
    # As if the run had been killed in its last step.
    (tmp_path / "out" / "summary.json").unlink()
    done = grainlaw(*falling_spring(tmp_path, **edit), "--resume")
    assert (done.returncode == 0) is goes_on
    if not goes_on:
        assert re.search(
            r"out: the law spring \(.*springy\.py\) was changed since the run began; .* --overwrite\n$", done.stderr
        )
        assert done.stderr.count("\n") == 1


def test_a_second_run_into_the_folder_of_a_run_is_refused(tmp_path):
    scene = Scene.from_dict(with_output("vtu", {"time.end": 0.02}))
    refused = []

    def start_another(simulation, dt):
        for choice in ({"overwrite": True}, {"resume": True}, {}):
            with pytest.raises(InputError, match=r"another run is writing to .*; wait for its end") as caught:
                run(scene, tmp_path, **choice)
            refused.append(str(caught.value))

    before = run(scene, tmp_path, progress=start_another)
    assert len(refused) == 3 * before.steps
    assert run(scene, tmp_path, overwrite=True).final == before.final


# The command on a disk on which no file can be larger than so many bytes, from the fourth frame on.
ON_A_FULL_DISK = """
import resource, sys
from grainlaw.cli.main import main
from grainlaw.mpm_core.output import recorder

write, limit = recorder.Recorder._write_frame, int(sys.argv.pop())
def write_frame(self):
    if self.clock.next_frame == 3:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    write(self)
recorder.Recorder._write_frame = write_frame
main()
"""


def size_of(folder, name):
    return (folder / name).stat().st_size


FILES = [("vtu", "points_000001.vtu"), ("vtkhdf", "run.vtkhdf"), ("vtkhdf", "checkpoint.h5"), ("both", "history.csv")]


@pytest.mark.parametrize(("output", "name"), FILES)
def test_a_full_disk_ends_in_one_line_and_the_run_goes_on_to_the_same_bits(tmp_path, output, name):
    scene = Scene.from_dict(with_output(output))
    whole, full = tmp_path / "whole", tmp_path / "full"
    run(scene, whole)
    # too small for the file that is meant; the others are smaller, or come later
    limit = {"run.vtkhdf": 150_000, "history.csv": 4_000}.get(name, size_of(whole, name) - 500)
    command = [sys.executable, "-c", ON_A_FULL_DISK, "run", write_scene(tmp_path / "s.toml", with_output(output))]
    done = subprocess.run(
        [*command, "--out", full, "--threads", "1", str(limit)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1, done
    assert re.fullmatch(
        rf"error: {full} cannot be written: File too large; --resume goes on from t = 0\.06 s, last checkpoint: "
        rf"{full / 'checkpoint.h5'}",
        done.stderr.splitlines()[-1],
    )
    assert not list(full.glob(".partial-*"))
    run(scene, full, resume=True)
    assert_same_runs(whole, full)


def test_a_disk_that_is_full_from_the_start_is_one_line(tmp_path, monkeypatch, capsys):
    def refuse(*arguments):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(recorder, "write_checkpoint", refuse)
    path = write_scene(tmp_path / "scene.toml", with_output("vtu"))
    assert call_command_line(monkeypatch, "run", path, "--out", tmp_path / "out") == 1
    assert capsys.readouterr().err == (
        f"error: {tmp_path / 'out'} cannot be written: No space left on device; there is no checkpoint yet: "
        "--overwrite begins the run again\n"
    )


def test_ctrl_c_says_how_to_go_on(tmp_path):
    endless = with_output("vtu", {**FINE, "time.end": 60.0})  # so that no busy machine ends it before the signal comes
    scene_file, out = write_scene(tmp_path / "scene.toml", endless), tmp_path / "out"
    command = [sys.executable, "-m", "grainlaw", "run", scene_file, "--out", out, "--threads", "1"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 120
    while not (out / "points_000002.vtu").exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    printed, errors = process.communicate(timeout=60)
    assert process.returncode == 1
    assert printed == ""
    line = errors.splitlines()[-1]
    assert re.fullmatch(
        rf"error: stopped by Ctrl-C; --resume goes on from t = \S+ s, last checkpoint: {out / 'checkpoint.h5'}", line
    )
    assert "Traceback" not in errors
    time_of_checkpoint = float(re.search(r"t = (\S+) s", line)[1])
    assert time_of_checkpoint == pytest.approx(read_collection(out)[-1].time, abs=0.031)


@pytest.mark.parametrize("steps_before", [0, 3])
def test_ctrl_c_in_a_callback_that_swallows_it_stops_the_run_after_the_step(tmp_path, steps_before):
    taken = []

    def swallow(simulation, dt):
        taken.append(dt)
        if len(taken) > steps_before:
            with contextlib.suppress(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt) as stopped:
        run(Scene.from_dict(COLUMN), tmp_path / "out", progress=swallow)
    assert len(taken) == steps_before + 1
    assert stopped.value.__notes__ == [f"stopped by Ctrl-C; {how_to_go_on(tmp_path / 'out')}"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_ctrl_c_waits_for_the_step_and_a_second_one_does_not():
    with interrupts_noted() as interrupts:
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            interrupts.after_step()
    with interrupts_noted() as interrupts:
        interrupts.after_step()
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            interrupts.after_step()
