"""How many threads a run may use."""

import os

# Idle threads of OpenMP spin by default, which on a busy machine takes the time of those that work. Spin briefly, then
# sleep. It has to be set before the first parallel kernel loads the library.
os.environ.setdefault("GOMP_SPINCOUNT", "1000")

import numba

from materials import InputError

# TBB, which numba prefers, waits at the end of a process for its threads by spinning: for minutes on a busy machine.
numba.config.THREADING_LAYER_PRIORITY = ["omp", "tbb", "workqueue"]  # type: ignore[attr-defined]


def usable_threads(requested: int | None) -> int:
    """The requested number, or all cores of this process. Raises InputError beyond what the machine has."""
    available = min(len(os.sched_getaffinity(0)), int(numba.config.NUMBA_NUM_THREADS))  # type: ignore[attr-defined]
    if requested is None:
        return available
    if requested > available:
        raise InputError(f"--threads {requested}: this machine has {available}")
    return requested


def use_threads(count: int) -> None:
    """Let parallel kernels run on `count` threads."""
    numba.set_num_threads(count)
