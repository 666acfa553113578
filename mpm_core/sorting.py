"""Keeping points sorted by the cell of their stencil: cache-friendly transfers, and stripes that threads can share.

A stripe is STRIPE columns of stencils. Between two sorts no point may drift by more than one cell, so that a stripe
reaches at most one column further on either side, plus its stencil; stripes of equal parity then share no node.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from materials.compilation import named
from mpm_core.columns import X, Y
from mpm_core.grid import Window
from mpm_core.sources import CORE_MARK

STRIPE = 8
LONGEST_DRIFT = 0.9


def sort_by_stencil(
    points: NDArray[np.float64], origin: tuple[float, float], cell_size: float, offset: float, window: Window
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """The stable order of points by column and row of their stencil, and the first point of each stripe.

    Orders are kept in 32 bits, as ids are: with many points they are what memory peaks with.
    """
    columns = window.last_x - window.first_x + 1
    rows = window.last_y - window.first_y + 1
    return _counting_sort(points, *origin, cell_size, offset, window.first_x, window.first_y, columns, rows)


@njit(cache=True)
@named(CORE_MARK)
def _counting_sort(  # type: ignore[no-untyped-def]
    points, origin_x, origin_y, cell_size, offset, first_x, first_y, columns, rows
):
    count = points.shape[1]
    x, y = points[X], points[Y]
    keys = np.empty(count, np.int32)
    starts = np.zeros(columns * rows + 1, np.int64)
    for p in range(count):
        i = int((x[p] - origin_x) / cell_size - offset) - first_x
        j = int((y[p] - origin_y) / cell_size - offset) - first_y
        keys[p] = i * rows + j
        starts[keys[p] + 1] += 1
    for key in range(columns * rows):
        starts[key + 1] += starts[key]
    stripes = -(-columns // STRIPE)
    stripe_starts = np.empty(stripes + 1, np.int64)
    for stripe in range(stripes + 1):
        stripe_starts[stripe] = starts[min(stripe * STRIPE, columns) * rows]
    order = np.empty(count, np.int32)
    for p in range(count):
        order[starts[keys[p]]] = p
        starts[keys[p]] += 1
    return order, stripe_starts


def reorder(points: NDArray[np.float64], ids: NDArray[np.int32], order: NDArray[np.int32], first: int = 0) -> None:
    """Bring points from `first` on, as many as `order` names, into an order, and their ids."""
    places, room = slice(first, first + len(order)), np.empty(len(order))
    for column in points:
        _gather(column, order, room)
        column[places] = room
    ids[places] = ids[order]


@njit(cache=True)
@named(CORE_MARK)
def _gather(column, order, found):  # type: ignore[no-untyped-def]
    for p in range(len(order)):
        found[p] = column[order[p]]


def balanced_chunks(stripe_starts: NDArray[np.int64], threads: int) -> NDArray[np.int64]:
    """Boundaries of `threads` runs of stripes that hold about the same number of points each."""
    targets = np.linspace(0, stripe_starts[-1], threads + 1)
    boundaries = np.searchsorted(stripe_starts, targets)
    boundaries[0], boundaries[-1] = 0, len(stripe_starts) - 1
    return boundaries.astype(np.int64)
