"""Kernels compile once per machine: the first run of a batch there goes ahead, the others wait until it has them."""

import hashlib
import os
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path
from typing import Any

from numba.core.event import Listener, install_listener

from grainlaw.mpm_core.scene.model import Scene

try:
    import fcntl
except ImportError:  # Windows has no such module; there runs do not wait for one another.
    fcntl = None  # type: ignore[assignment]

# Some kernels are first needed when material has moved. After so much processor time without compiling anything [s],
# all are taken to be there.
CALM = 5.0


@contextmanager
def compiled_once(scene: Scene, batch: str) -> Iterator[Callable[[], None]]:
    """Around a run of a batch; yields what to call after each of its steps.

    The first run of scenes with the same kernels on this machine holds back those that begin meanwhile, until it ends
    or has stepped for a while without compiling. Where it fails or its process is killed, the next one goes ahead.
    """
    kernels = _kernels_of(scene)
    with _held_file() as file:
        if file is None or kernels in _ready(file, batch):
            _release(file)
            yield lambda: None
            return
        ahead = _Ahead(lambda: _tell(file, batch, kernels))
        with install_listener("numba:compile", ahead):
            yield ahead.step
        ahead.tell()


class _Ahead(Listener):
    """Tells once that kernels are there."""

    def __init__(self, tell: Callable[[], None]) -> None:
        self._tell: Callable[[], None] | None = tell
        self._compiled = time.thread_time()

    def on_start(self, event: Any) -> None:
        pass

    def on_end(self, event: Any) -> None:
        self._compiled = time.thread_time()

    def step(self) -> None:
        if time.thread_time() - self._compiled > CALM:
            self.tell()

    def tell(self) -> None:
        tell, self._tell = self._tell, None
        if tell is not None:
            tell()


def _kernels_of(scene: Scene) -> str:
    """What is the same for scenes that need the same kernels: all but numbers and the title."""
    content = scene.model_dump(mode="json", exclude={"title"})
    return hashlib.sha256(repr(_without_numbers(content)).encode()).hexdigest()


def _without_numbers(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _without_numbers(entry) for name, entry in value.items()}
    if isinstance(value, list):
        return [_without_numbers(entry) for entry in value]
    return 0 if isinstance(value, int | float) and not isinstance(value, bool) else value


@contextmanager
def _held_file() -> Iterator[TextIOWrapper | None]:
    """The user's file of what is compiled, held as soon as nobody else holds it; None where there is no such file.

    It lies where other machines do not look. The system gives it back when the process ends, however that happens.
    """
    if fcntl is None:
        yield None
        return
    path = Path(tempfile.gettempdir()) / f"grainlaw-compiled-{os.getuid()}"
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
    except OSError:
        yield None
        return
    with open(descriptor, "r+", encoding="utf-8") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield file


def _release(file: TextIOWrapper | None) -> None:
    if file is not None:
        fcntl.flock(file, fcntl.LOCK_UN)


def _ready(file: TextIOWrapper, batch: str) -> list[str]:
    """What the batch has compiled; nothing where the file is that of another."""
    file.seek(0)
    first, *others = file.read().splitlines() or [""]
    return others if first == batch else []


def _tell(file: TextIOWrapper, batch: str, kernels: str) -> None:
    lines = [batch, *_ready(file, batch), kernels]
    file.seek(0)
    file.truncate()
    file.write("\n".join(lines) + "\n")
    file.flush()
    _release(file)
