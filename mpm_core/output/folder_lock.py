"""One run at a time writes to a folder: a second would mix its files with those of the first."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from grainlaw.materials import InputError

try:
    import fcntl
except ImportError:  # Windows has no such module; there the folder is not held.
    fcntl = None  # type: ignore[assignment]


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Hold a folder for the time of a run; the system gives it back when the process ends, however that happens.

    Raises InputError where another run holds it. On file systems without locks nothing is held.
    """
    if fcntl is None:
        yield
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(f"another run is writing to {folder}; wait for its end, or choose another --out") from None
        except OSError:
            pass
        yield
    finally:
        os.close(descriptor)
