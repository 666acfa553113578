"""Which frames and points a page shows, so that it stays small."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# Frames are left out before a body has fewer points than these.
FEWEST_POINTS = 4000


@dataclass(frozen=True)
class Thinning:
    """Which frames are kept, one of how many points, and what the reader is told about it."""

    frames: tuple[int, ...]
    points_each: float
    notes: tuple[str, ...]

    def numbers(self, count: int) -> NDArray[np.int64]:
        """The numbers of the points that are kept of `count`.

        One at a random place of each stretch of neighbours: every so many would leave out rows of a lattice. The same
        points in all frames, as long as none has left.
        """
        stretches = np.floor(self.points_each * np.arange(int(count / self.points_each) + 2)).astype(np.int64)
        widths = np.diff(stretches)
        chosen = stretches[:-1] + np.floor(np.random.default_rng(0).random(len(widths)) * widths).astype(np.int64)
        return chosen[chosen < count]


def thinned(counts: Sequence[int], size: int, most_bytes: int) -> Thinning:
    """What is kept of frames of so many points, each of `size` bytes, so that `most_bytes` hold it."""
    most = max(counts)
    step = max(1, int(np.ceil(len(counts) * min(most, FEWEST_POINTS) * size / most_bytes)))
    frames = tuple(dict.fromkeys([*range(0, len(counts), step), len(counts) - 1]))
    points_each = max(1.0, sum(counts[index] for index in frames) * size / most_bytes)
    notes = []
    if len(frames) < len(counts):
        notes.append(f"Shown are {len(frames)} of {len(counts)} frames.")
    if points_each > 1.0:
        notes.append(f"Shown is one of {points_each:.3g} points, drawn larger.")
    return Thinning(frames, points_each, tuple(notes))
