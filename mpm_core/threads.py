"""How many threads a run may use."""

import os

import numba

from materials import InputError


def usable_threads(requested: int | None) -> int:
    """The requested number, or all cores of this process. Raises InputError beyond what the machine has."""
    available = min(len(os.sched_getaffinity(0)), int(numba.config.NUMBA_NUM_THREADS))  # type: ignore[attr-defined]
    if requested is None:
        return available
    if requested > available:
        raise InputError(f"--threads {requested}: this machine has {available}")
    return requested
