"""Signals that ask to end, noted where the work can be left in order."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

# Ctrl-C, `kill` and the end of the terminal.
ASKING_TO_END = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Stopped(BaseException):
    """The work was left because a signal asked for it; no failure, so that no handler of failures goes on after it."""


class StopRequest:
    """The signal that asked this process to end, if one did."""

    def __init__(self) -> None:
        self._received: signal.Signals | None = None

    def note(self, number: int, _: FrameType | None) -> None:
        """Take the signal; nothing ends here, since a process may just be starting."""
        self._received = signal.Signals(number)

    def obey(self) -> None:
        """Raise Stopped if a signal has come."""
        if self._received is not None:
            raise Stopped(self._received.name)


@contextmanager
def noting_stop_requests() -> Iterator[StopRequest]:
    """Within the block, signals that ask to end are noted instead of ending the process; for the main thread."""
    request = StopRequest()
    before = {number: signal.signal(number, request.note) for number in ASKING_TO_END}
    try:
        yield request
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
