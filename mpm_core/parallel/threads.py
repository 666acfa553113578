"""How many threads a run may use, and starting them."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from numbers import Integral

import numba

from grainlaw.materials import InputError
from grainlaw.mpm_core.parallel.idle_threads import turns_awake

# TBB, which numba prefers, waits at the end of a process for its threads by spinning: for minutes on a busy machine.
LAYERS = ["omp", "tbb", "workqueue"]
SPIN_COUNT = "GOMP_SPINCOUNT"


def cores() -> int:
    """How many cores this process may use."""
    return min(_cores_of_process(), int(numba.config.NUMBA_NUM_THREADS))  # type: ignore[attr-defined]


def usable_threads(requested: int | None) -> int:
    """The requested number, or the cores that no other work on the machine keeps busy, at least one.

    Threads wait for one another after every pass of a step, so that one more than there are idle cores can make a run
    ten times slower; its results do not depend on the number. Raises InputError beyond what the machine has.
    """
    available = cores()
    if requested is None:
        return max(1, available - _busy_cores())
    _refuse_other_than(available, requested)
    return requested


def _refuse_other_than(available: int, threads: int) -> None:
    if not isinstance(threads, Integral) or isinstance(threads, bool) or not 1 <= threads <= available:
        raise InputError(f"threads = {threads}: this machine has {available}; allowed: 1 to {available}")


def use_threads(count: int) -> None:
    """Let parallel kernels run on `count` threads. Raises InputError beyond what the machine has."""
    _refuse_other_than(int(numba.config.NUMBA_NUM_THREADS), count)  # type: ignore[attr-defined]
    _start_threads()
    numba.set_num_threads(count)


@cache
def _start_threads() -> None:
    """Load the threading library, OpenMP's where there is one, with idle threads that sleep after a while.

    By default OpenMP's spin, which on a busy machine takes the time of those that work: two runs with two threads each
    on two cores take seven times as long. The library reads the environment once, as it is loaded; afterwards the
    environment and numba's settings are what they were, for whatever else this process does or starts.
    """
    with _preferred_layers(), _environment(SPIN_COUNT, str(turns_awake())):
        numba.set_num_threads(1)


@contextmanager
def _preferred_layers() -> Iterator[None]:
    before = numba.config.THREADING_LAYER_PRIORITY  # type: ignore[attr-defined]
    numba.config.THREADING_LAYER_PRIORITY = LAYERS  # type: ignore[attr-defined]
    try:
        yield
    finally:
        numba.config.THREADING_LAYER_PRIORITY = before  # type: ignore[attr-defined]


@contextmanager
def _environment(name: str, value: str) -> Iterator[None]:
    """Set a variable of the environment for a while, where it is not set already."""
    if name in os.environ:
        yield
        return
    os.environ[name] = value
    try:
        yield
    finally:
        del os.environ[name]


def _cores_of_process() -> int:
    """The cores that the system lets this process use; where it does not tell, those of the machine."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _busy_cores() -> int:
    """How many cores other work has kept busy in the last minute; none where the system does not tell."""
    try:
        return round(os.getloadavg()[0])
    except (AttributeError, OSError):
        return 0
