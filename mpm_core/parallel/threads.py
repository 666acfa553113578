"""How many threads a run may use."""

import os
from functools import cache

import numba

from grainlaw.materials import InputError
from grainlaw.mpm_core.parallel.idle_threads import turns_awake

# TBB, which numba prefers, waits at the end of a process for its threads by spinning: for minutes on a busy machine.
numba.config.THREADING_LAYER_PRIORITY = ["omp", "tbb", "workqueue"]  # type: ignore[attr-defined]


def cores() -> int:
    """How many cores this process may use."""
    return min(len(os.sched_getaffinity(0)), int(numba.config.NUMBA_NUM_THREADS))  # type: ignore[attr-defined]


def usable_threads(requested: int | None) -> int:
    """The requested number, or the cores that no other work on the machine keeps busy, at least one.

    Threads wait for one another after every pass of a step, so that one more than there are idle cores can make a run
    ten times slower; its results do not depend on the number. Raises InputError beyond what the machine has.
    """
    available = cores()
    if requested is None:
        return max(1, available - round(os.getloadavg()[0]))
    if requested > available:
        raise InputError(f"--threads {requested}: this machine has {available}")
    return requested


def use_threads(count: int) -> None:
    """Let parallel kernels run on `count` threads."""
    _limit_spinning()
    numba.set_num_threads(count)


@cache
def _limit_spinning() -> None:
    """Let idle threads sleep after a while.

    By default OpenMP's spin, which on a busy machine takes the time of those that work: two runs with two threads each
    on two cores take seven times as long. It has to be set before the library is loaded.
    """
    os.environ.setdefault("GOMP_SPINCOUNT", str(turns_awake()))
