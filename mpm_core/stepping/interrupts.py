"""Ctrl-C that neither gets lost nor tears a step apart."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Interrupts:
    """Ctrl-C while a run steps: until the first step is done, which compiles for long, at once, then between steps.

    A KeyboardInterrupt that rises in a callback of a library, of a weak reference for instance, ends there unseen, with
    a traceback on stderr.
    """

    def __init__(self) -> None:
        self._came = False
        self._waits_for_step = False

    def take(self, number: int, frame: FrameType | None) -> None:
        """Note the signal; raise KeyboardInterrupt where it does not wait for the step, and at the second one."""
        is_first, self._came = not self._came, True
        if not (is_first and self._waits_for_step):
            signal.default_int_handler(number, frame)

    def after_step(self) -> None:
        """Raise the KeyboardInterrupt that waits, or that a callback has swallowed."""
        if self._came:
            raise KeyboardInterrupt
        self._waits_for_step = True


@contextmanager
def interrupts_noted() -> Iterator[Interrupts]:
    """Within the block, Ctrl-C is taken by `Interrupts`, unless somebody's own handler takes it."""
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
