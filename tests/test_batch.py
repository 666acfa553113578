"""Batches of runs on many processes: killed workers, lost schedulers, failures, kernels that compile once."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

import pytest
from distributed import Client, KilledWorker, get_worker
from scenes_for_tests import BLOCK, FALLING_SPRING, changed, fresh_registry, write_plugin

from grainlaw.materials import InputError, SimulationError
from grainlaw.mpm_core import Scene, run
from grainlaw.studies import cluster, kernels
from grainlaw.studies.batch import (
    Member,
    Outcome,
    _files_of_laws,
    _reason,
    _say_once_when_it_compiles,
    perform,
    run_members,
)
from grainlaw.studies.kernels import compiled_once

__all__ = ["fresh_registry"]

# A block that bounces for about half a second of wall time.
BOUNCING = changed(
    BLOCK,
    {"gravity": [0.0, -9.81], "time.end": 0.5, "time.safety": 0.02, "output": {"pictures": False, "interval": 0.05}},
)


def members(count, changes=None):
    return [
        Member(f"{n:02d}", changed(BOUNCING, {"body.0.density": 1000.0 + n, **(changes or {})})) for n in range(count)
    ]


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


class Cluster:
    """A scheduler and two workers, each a process of its own."""

    def __init__(self):
        self.port = free_port()
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.start()

    def start(self):
        host = ("--host", "127.0.0.1", "--no-dashboard")
        self.scheduler = self._process("scheduler", "--port", str(self.port), *host)
        wait_for(self._answers)
        own = ("--nthreads", "1", "--no-nanny", "--death-timeout", "60")
        self.workers = [self._process("worker", self.address, *own, *host) for _ in range(2)]
        with Client(self.address) as client:
            client.wait_for_workers(2, timeout=120)

    def stop(self):
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()

    def _answers(self):
        with socket.socket() as tried:
            return tried.connect_ex(("127.0.0.1", self.port)) == 0

    def _process(self, *arguments):
        program = [sys.executable, "-m", "dask", *arguments]
        return subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.fixture(scope="module")
def processes():
    found = Cluster()
    yield found
    found.stop()


def begun(out):
    """The folders of runs that have begun and are not finished."""
    return [path.parent for path in out.glob("*/checkpoint.h5") if not (path.parent / "summary.json").exists()]


def in_the_middle(worker, out):
    """Whether a process holds the folder of a run that has begun and is not finished."""
    folders = {str(folder) for folder in begun(out)}
    with contextlib.suppress(FileNotFoundError):
        return any(os.readlink(opened) in folders for opened in os.scandir(f"/proc/{worker.pid}/fd"))
    return False


def wait_for(condition):
    until = time.monotonic() + 120.0
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.01)


def finished_at(outcomes):
    return {outcome.name: (outcome.folder / "summary.json").stat().st_mtime_ns for outcome in outcomes}


def test_members_that_fail_are_told_and_the_others_go_on(processes, tmp_path):
    asked = members(5, {"time.end": 0.01})
    # One cannot be built, one cannot go on, one has no such key.
    for number, (key, value) in {1: ("grid.upper", [0.5, 0.8]), 2: ("time.smallest_step", 1.0), 4: ("x", 1)}.items():
        asked[number] = Member(asked[number].name, changed(asked[number].scene, {key: value}))
    reported = []
    outcomes = run_members(asked, tmp_path, scheduler=processes.address, report=reported.append)
    assert [outcome.name for outcome in outcomes] == ["00", "01", "02", "03", "04"]
    assert [outcome.name for outcome in outcomes if outcome.reason] == ["01", "02", "04"]
    assert "time.smallest_step" in outcomes[2].reason
    assert "unknown key 'x'" in outcomes[4].reason
    assert all("\n" not in outcome.reason for outcome in outcomes)
    assert sorted(reported, key=lambda outcome: outcome.name) == outcomes
    run(Scene.from_dict(asked[3].scene), tmp_path / "alone")
    assert (outcomes[3].folder / "history.csv").read_text().splitlines()[-1].rpartition(",")[0] == (
        tmp_path / "alone" / "history.csv"
    ).read_text().splitlines()[-1].rpartition(",")[0]
    assert (outcomes[3].folder / "scene.toml").read_text() == (tmp_path / "alone" / "scene.toml").read_text()


def test_runs_of_a_killed_worker_are_repeated(processes, tmp_path):
    killed = []

    def killed_in_the_middle():
        for worker in processes.workers:
            if in_the_middle(worker, tmp_path):
                worker.kill()
                killed.append(worker)
                break
        return killed

    def kill_in_the_middle(outcome):
        if not killed:
            wait_for(killed_in_the_middle)

    outcomes = run_members(members(4), tmp_path, scheduler=processes.address, report=kill_in_the_middle)
    assert killed[0].wait() == -signal.SIGKILL
    assert [outcome.reason for outcome in outcomes] == [""] * 4
    assert len(finished_at(outcomes)) == 4
    assert begun(tmp_path) == []


def test_a_batch_goes_on_after_its_scheduler_was_lost(processes, tmp_path):
    known = []

    def stop_in_the_middle(outcome):
        known.append(outcome)
        if len(known) == 2:
            processes.stop()

    with pytest.raises(SimulationError, match=r"the scheduler .* is gone; 2 of 4 runs are finished; --resume goes on"):
        run_members(members(4), tmp_path, scheduler=processes.address, report=stop_in_the_middle)
    before = finished_at(known)
    processes.start()
    outcomes = run_members(members(4), tmp_path, scheduler=processes.address, resume=True)
    assert [outcome.reason for outcome in outcomes] == [""] * 4
    assert finished_at(outcomes).items() >= before.items()


def test_that_kernels_are_compiled_is_said_once(processes, monkeypatch):
    said = []
    monkeypatch.setattr("grainlaw.progress.say_that_it_compiles", lambda: said.append("compiling"))
    with Client(processes.address) as client:
        _say_once_when_it_compiles(client, "batch")
        told = [client.submit(lambda n: get_worker().log_event("batch", n), n) for n in range(3)]
        client.gather(told)
        wait_for(lambda: len(client.get_events("batch")) == 3 and said)
    assert said == ["compiling"]


def test_finished_runs_need_no_worker_and_others_are_not_lost(tmp_path, monkeypatch):
    (member,) = members(1, {"time.end": 0.01})
    run(Scene.from_dict(member.scene), tmp_path / member.name)
    monkeypatch.setattr("grainlaw.studies.batch.workers_of", None)
    assert run_members([member], tmp_path, resume=True) == [Outcome("00", tmp_path / "00", "")]
    with pytest.raises(InputError, match=r"00 already holds a run; choose another --out, or --resume"):
        run_members([member], tmp_path)
    other = Member(member.name, changed(member.scene, {"body.0.density": 2000.0}))
    with pytest.raises(InputError, match=r"another scene.*body.0.density = 1000.0 there, 2000.0 here"):
        run_members([other], tmp_path, resume=True)


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:{port}", "tacp://127.0.0.1:{port}", "nowhere"])
def test_a_scheduler_that_does_not_answer_is_told_in_a_line(tmp_path, monkeypatch, address):
    monkeypatch.setattr(cluster, "PATIENCE", 1)
    address = address.format(port=free_port())
    with pytest.raises(InputError, match=f"no scheduler answers at {address} within 1 s"):
        run_members(members(1), tmp_path, scheduler=address)


def test_workers_load_the_files_of_laws(tmp_path, fresh_registry):
    path = write_plugin(tmp_path / "spring.py")
    scene = changed(FALLING_SPRING, {"material.spring.stiffness": -1.0})
    assert "unknown law 'spring'" in perform(scene, tmp_path / "00", [], "batch")
    assert "stiffness = -1" in perform(scene, tmp_path / "00", [path], "batch")
    assert path in _files_of_laws()


def test_a_run_whose_workers_are_killed_again_and_again_tells_so():
    killed = SimpleNamespace(exception=lambda: KilledWorker("00", None, 3))
    assert _reason(killed) == "4 workers were killed with this run, perhaps for their memory"
    lost = SimpleNamespace(exception=lambda: ModuleNotFoundError("No module named\n'grainlaw'"))
    assert _reason(lost) == "ModuleNotFoundError: No module named 'grainlaw'"


@pytest.fixture
def own_file(tmp_path, monkeypatch):
    monkeypatch.setattr(kernels.tempfile, "gettempdir", lambda: str(tmp_path))


class Begins(threading.Thread):
    """A run of a batch in another thread, until it has begun."""

    def __init__(self, scene, batch):
        super().__init__(daemon=True)
        self.scene, self.batch = scene, batch
        self.start()

    def run(self):
        with compiled_once(self.scene, self.batch):
            pass

    def waits(self):
        self.join(0.2)
        return self.is_alive()


def test_the_first_run_compiles_while_the_others_wait(own_file, monkeypatch):
    scene, same = Scene.from_dict(BLOCK), Scene.from_dict(changed(BLOCK, {"body.0.density": 2000.0}))
    other = Scene.from_dict(changed(BLOCK, {"transfer.basis": "cubic"}))
    with compiled_once(scene, "batch") as stepped:
        second, third = Begins(same, "batch"), Begins(other, "batch")
        stepped()
        assert second.waits()
        assert third.waits()
        monkeypatch.setattr(kernels, "CALM", 0.0)
        stepped()
        assert not second.waits()
        assert not third.waits()
        # Kernels that are known to be there are waited for by nobody.
        assert not Begins(same, "batch").waits()


def test_where_the_first_run_fails_the_next_one_compiles(own_file):
    scene = Scene.from_dict(BLOCK)
    with contextlib.suppress(ZeroDivisionError), compiled_once(scene, "batch"):
        raise ZeroDivisionError
    with compiled_once(scene, "batch"):
        assert Begins(scene, "batch").waits()


def test_without_a_place_for_the_file_nobody_waits(tmp_path, monkeypatch):
    monkeypatch.setattr(kernels.tempfile, "gettempdir", lambda: os.fspath(tmp_path / "missing"))
    scene = Scene.from_dict(BLOCK)
    with compiled_once(scene, "batch"):
        assert not Begins(scene, "batch").waits()
