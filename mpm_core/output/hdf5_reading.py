"""HDF5 files that somebody else may have damaged, opened so that reading them comes to an end.

In a damaged file the library may go round for ever, or crash, where Python cannot stop it. Another process therefore
goes through the file first, and is ended by the system when it takes too long.
"""

import atexit
import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.mpm_core.output import hdf5_walk
from grainlaw.mpm_core.output.hdf5_file import is_sealed

# Processor time for one part of a file [s], and per byte of the file, which may be one list of names or chunks.
LONGEST_STEP = 3.0
LONGEST_STEP_PER_BYTE = 3e-8
# A byte that is packed by deflate stands for 1032 at most.
MOST_BYTES_PER_BYTE = 1032
NUMBERS = "biuf"
# What the library raises for a damaged file, and what the parts of a file of another kind lead to.
UNREADABLE = (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError, MemoryError)


@contextmanager
def existing_hdf5(path: Path) -> Iterator[h5py.File]:
    """A file, open for reading.

    Raises OSError for one that is missing or no HDF5, and InputError in one line for a damaged one: one that is sealed
    and was changed, or in which the library would not come to an end or would crash.
    """
    if not is_sealed(path):
        refuse_endless(path)
    with h5py.File(path) as file:
        yield file


def refuse_endless(path: Path) -> None:
    """Raises InputError for a file in which HDF5 would not come to an end or would crash; any other may pass."""
    size = path.stat().st_size
    _walker.go_through(path, LONGEST_STEP + LONGEST_STEP_PER_BYTE * size)


def numbers_of(dataset: h5py.Dataset, rows: slice | tuple[()] = ()) -> NDArray[Any]:
    """The numbers of a dataset, or some rows of them.

    Raises TypeError for anything else, and ValueError for a damaged one that claims more of them than its file can
    hold.
    """
    if not isinstance(dataset, h5py.Dataset) or dataset.dtype.kind not in NUMBERS:
        raise TypeError(f"{dataset.name} does not hold numbers")
    elsewhere = dataset.is_virtual or dataset.external
    if not elsewhere and dataset.nbytes > MOST_BYTES_PER_BYTE * dataset.file.id.get_filesize():
        raise ValueError(f"{dataset.name} claims the shape {dataset.shape}, more than the file can hold")
    return np.asarray(dataset[rows])


class _Walker:
    """The process that goes through files: begun with the first, and anew where a file has ended it."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None
        self._owner = 0
        self._lock = Lock()

    def go_through(self, path: Path, seconds: float) -> None:
        with self._lock:
            process = self._running()
            assert process.stdin is not None
            assert process.stdout is not None
            try:
                process.stdin.write(json.dumps([str(path.absolute()), seconds]) + "\n")
                process.stdin.flush()
                if process.stdout.readline():
                    return
                code = process.wait()
            except BaseException:
                # Its answer would be taken for that to the next question.
                process.kill()
                raise
            self.end()
        if code == -signal.SIGXCPU:
            raise InputError(f"{path} is damaged: HDF5 comes to no end with a part of it within {seconds:.1f} s")
        if code < 0:
            raise InputError(f"{path} is damaged: HDF5 crashes on it ({signal.Signals(-code).name})")
        raise RuntimeError(f"{hdf5_walk.__file__} ended with {code}")

    def _running(self) -> subprocess.Popen[str]:
        # One that a fork left us with is the parent's.
        if self._process is None or self._owner != os.getpid() or self._process.poll() is not None:
            self.end()
            self._owner = os.getpid()
            self._process = subprocess.Popen(
                [sys.executable, "-P", str(hdf5_walk.__file__)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
                encoding="utf-8",
                # Ctrl-C is for us: it ends when we do.
                start_new_session=True,
            )
        return self._process

    def end(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        for pipe in (process.stdin, process.stdout):
            assert pipe is not None
            pipe.close()
        if self._owner == os.getpid():
            process.wait()


_walker = _Walker()
atexit.register(_walker.end)
