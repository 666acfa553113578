"""Starting threads leaves no trace in the environment, and what Linux alone tells has an answer elsewhere."""

import os
import subprocess
import sys

import pytest

from grainlaw.materials import InputError
from grainlaw.mpm_core.parallel import threads
from grainlaw.mpm_core.stepping import peak_memory


def printed(program, **environment):
    """Standard output and errors of a program with more variables in its environment."""
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout, done.stderr


START = """
import os, numba
before, layers = dict(os.environ), numba.config.THREADING_LAYER_PRIORITY
from grainlaw.mpm_core.parallel.threads import use_threads
use_threads(1)
print("started", dict(os.environ) == before, layers == numba.config.THREADING_LAYER_PRIORITY)
"""


def test_idle_threads_of_openmp_sleep_and_the_environment_is_what_it_was():
    # The library itself says which settings it has read.
    out, err = printed(START, OMP_DISPLAY_ENV="verbose")
    assert out == "started True True\n"
    (count,) = [line.split("'")[1] for line in err.splitlines() if "GOMP_SPINCOUNT" in line]
    assert 0 < int(count) < 100_000


def test_a_spin_count_of_the_user_is_kept():
    _, err = printed(START, OMP_DISPLAY_ENV="verbose", GOMP_SPINCOUNT="77")
    assert "GOMP_SPINCOUNT = '77'" in err


@pytest.mark.skipif(not os.path.isdir("/proc/self/task"), reason="only Linux lists the threads of a process")
def test_importing_starts_no_thread_and_changes_no_variable():
    program = """
import os
before = dict(os.environ)
import grainlaw, grainlaw.materials
print(len(os.listdir("/proc/self/task")))
import distributed, numpy, matplotlib, numba, pyarrow.csv, pyvista, scipy.spatial
from_libraries, libraries = len(os.listdir("/proc/self/task")), dict(os.environ)
for name in grainlaw.__all__:
    getattr(grainlaw, name)
import grainlaw.mpm_core, grainlaw.validation.catalogue, grainlaw.cli.main
print(len(os.listdir("/proc/self/task")) - from_libraries, dict(os.environ) == libraries)
"""
    assert printed(program)[0] == "1\n0 True\n"


def test_without_affinity_and_load_all_cores_of_the_machine_count(monkeypatch):
    monkeypatch.delattr(os, "sched_getaffinity")
    monkeypatch.delattr(os, "getloadavg")
    monkeypatch.setattr(os, "cpu_count", lambda: 3)
    monkeypatch.setattr(threads.numba.config, "NUMBA_NUM_THREADS", 8)
    assert threads.cores() == 3
    assert threads.usable_threads(None) == 3
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert threads.usable_threads(None) == 1


def test_a_load_that_cannot_be_had_counts_as_none(monkeypatch):
    def unobtainable():
        raise OSError

    monkeypatch.setattr(os, "getloadavg", unobtainable)
    assert threads.usable_threads(None) == threads.cores()


@pytest.mark.parametrize("count", [0, -1, 4096, 1.5, True])
@pytest.mark.parametrize("asked", [threads.usable_threads, threads.use_threads])
def test_a_number_of_threads_that_the_machine_has_not_is_refused(count, asked):
    with pytest.raises(InputError, match=f"threads = {count}: this machine has"):
        asked(count)


def test_peak_memory_is_in_bytes_and_0_where_the_system_does_not_tell(monkeypatch):
    assert 10e6 < peak_memory.peak_memory() < 1e12
    monkeypatch.setattr(peak_memory, "resource", None)
    assert peak_memory.peak_memory() == 0
