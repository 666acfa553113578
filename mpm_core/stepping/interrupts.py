"""Ctrl-C that cannot get lost."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Interrupts:
    """Whether Ctrl-C was pressed; a KeyboardInterrupt that rises in a callback of a library ends there unseen."""

    def __init__(self) -> None:
        self._came = False

    def take(self, number: int, frame: FrameType | None) -> None:
        """Note the signal and raise KeyboardInterrupt, as Python's own handler does."""
        self._came = True
        signal.default_int_handler(number, frame)

    def raise_lost(self) -> None:
        """Raise the KeyboardInterrupt that a callback has swallowed, if one was."""
        if self._came:
            raise KeyboardInterrupt


@contextmanager
def interrupts_noted() -> Iterator[Interrupts]:
    """Within the block, Ctrl-C is noted as well as raised, unless somebody's own handler takes it."""
    interrupts = Interrupts()
    in_main_thread = threading.current_thread() is threading.main_thread()
    if not in_main_thread or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield interrupts
        return
    signal.signal(signal.SIGINT, interrupts.take)
    try:
        yield interrupts
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
