"""When kernels are compiled, and for how long: the first run of a law on a machine waits for it."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba.core.event import TimingListener, install_listener


class Compilation(TimingListener):
    """The compilation of kernels in some time; what comes from disk is none."""

    def __init__(self, started: Callable[[], None]) -> None:
        super().__init__()
        self._started: Callable[[], None] | None = started

    def on_start(self, event: Any) -> None:
        """A kernel is about to be compiled."""
        started, self._started = self._started, None
        if started is not None:
            started()
        super().on_start(event)

    @property
    def seconds(self) -> float:
        """The time that it took so far [s]."""
        return float(self.duration) if self.done else 0.0


@contextmanager
def noticed_compilation(started: Callable[[], None] = lambda: None) -> Iterator[Compilation]:
    """Call a function when the first kernel is compiled, and measure the time that all take."""
    compilation = Compilation(started)
    with install_listener("numba:compile", compilation):
        yield compilation
