"""Files of others that a library may not survive: damaged ones in which it goes round for ever, or crashes.

Python cannot stop that. Another process therefore goes through the file first (`file_walk`), and is ended by the system
when it takes too long.
"""

import atexit
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from threading import Lock
from typing import Literal

from grainlaw.materials import InputError

WALK = Path(__file__).with_name("file_walk.py")
# Processor time for one part of a file [s], and per byte of the file, which may be one list of names, chunks or values.
LONGEST_STEP = 3.0
LONGEST_STEP_PER_BYTE = {"HDF5": 3e-8, "VTK": 3e-7}


def refuse_fatal(path: Path, kind: Literal["HDF5", "VTK"]) -> None:
    """Raises InputError for a file in which its library would not come to an end or would crash; any other may pass."""
    _walker.go_through(path, kind, LONGEST_STEP + LONGEST_STEP_PER_BYTE[kind] * path.stat().st_size)


class _Walker:
    """The process that goes through files: begun with the first, and anew where a file has ended it."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None
        self._owner = 0
        self._lock = Lock()

    def go_through(self, path: Path, kind: str, seconds: float) -> None:
        with self._lock:
            process = self._running()
            assert process.stdin is not None
            assert process.stdout is not None
            try:
                process.stdin.write(json.dumps([kind, str(path.absolute()), seconds]) + "\n")
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
            raise InputError(f"{path} is damaged: {kind} comes to no end with a part of it within {seconds:.1f} s")
        if code < 0:
            raise InputError(f"{path} is damaged: {kind} crashes on it ({signal.Signals(-code).name})")
        raise RuntimeError(f"{WALK} ended with {code}")

    def _running(self) -> subprocess.Popen[str]:
        # One that a fork left us with is the parent's.
        if self._process is None or self._owner != os.getpid() or self._process.poll() is not None:
            self.end()
            self._owner = os.getpid()
            self._process = subprocess.Popen(
                [sys.executable, "-P", str(WALK)],
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
