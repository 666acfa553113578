"""Keeping points sorted by the cell of their stencil: cache-friendly transfers, and stripes that threads can share.

A stripe is some layers of stencils along x. Between two sorts no point may drift by more than one cell, so that a
stripe reaches at most one layer further on either side, plus its stencil; stripes of equal parity then share no node
if each stripe is wider than a stencil. Stripes hold as many points as one another, and each parity has as many as two
or four threads can share equally. They follow from where the points are alone, so that sums are the same for any number
of threads.
"""

import math

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.materials.compilation import named
from grainlaw.mpm_core.kernels.shape_functions import Basis, first_node
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.parallel.blocks import EQUAL_SHARES

LONGEST_DRIFT = 0.9
# Cells that numbers of 32 bits count.
MOST_CELLS = 2**31 - 2
# Stripes come in multiples of the first, so that four threads have equal ranges of each parity; else of the second.
STRIPES_IN_TURN = (2 * EQUAL_SHARES, EQUAL_SHARES)


def sort_by_stencil(
    places: NDArray[np.float64], origin: tuple[float, ...], cell_size: float, basis: Basis
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """The stable order of points at `places`, shape (axes, n) [m], and the first point of each stripe.

    The order is that of their stencils, along the last axis first. Orders are kept in 32 bits, as ids are: with many
    points they are what memory peaks with. Raises InputError for points that spread over more cells than that counts.
    """
    if places.shape[1] == 0:
        return np.empty(0, np.int32), np.zeros(1, np.int64)
    ends = places.min(axis=1), places.max(axis=1)
    low, high = ((((end - origin) / cell_size) - basis.offset).astype(np.int64) for end in ends)
    extents = high - low + 1
    if math.prod(extents.tolist()) > MOST_CELLS:
        shape = " x ".join(map(str, extents))
        raise InputError(f"grid.cell_size = {cell_size:g}: the points spread over {shape} cells, too many to be sorted")
    return _counting_sort(places, tuple(low), tuple(extents), origin, cell_size, basis.offset, basis.width + 1)


@njit(cache=True)
@named(CORE_MARK)
def _stripe_starts(before, narrowest):  # type: ignore[no-untyped-def]
    """The first point of each stripe, and the one behind its last, from the points before each column."""
    columns = len(before) - 1
    most = max(1, columns // narrowest)
    for together in STRIPES_IN_TURN:
        for count in range(most - most % together, 0, -together):
            limits = _equal_parts(before, count)
            if _fewest_columns(limits) >= narrowest:
                return _at(before, limits)
    limits = np.empty(most + 1, np.int64)
    for part in range(most + 1):
        limits[part] = part * columns // most
    return _at(before, limits)


# Loops: what NumPy has for them takes the compiler longer than the rest of the sort.
@njit(cache=True)
@named(CORE_MARK)
def _fewest_columns(limits):  # type: ignore[no-untyped-def]
    """The columns of the narrowest part."""
    fewest = limits[-1]
    for part in range(len(limits) - 1):
        fewest = min(fewest, limits[part + 1] - limits[part])
    return fewest


@njit(cache=True)
@named(CORE_MARK)
def _at(values, positions):  # type: ignore[no-untyped-def]
    """The values at some positions."""
    found = np.empty(len(positions), values.dtype)
    for k in range(len(positions)):
        found[k] = values[positions[k]]
    return found


@njit(cache=True)
@named(CORE_MARK)
def _equal_parts(before, count):  # type: ignore[no-untyped-def]
    """The columns at which parts begin: of each parity, the first k hold about k times the points of one."""
    limits, held = np.zeros(count + 1, np.int64), np.zeros(2)
    for part in range(count):
        held_before = held[part % 2] - before[limits[part]]
        target = before[-1] * (part // 2 + 1) / count - held_before
        column = min(np.searchsorted(before, target), len(before) - 1)
        is_beyond = column > limits[part] and target - before[column - 1] < before[column] - target
        limits[part + 1] = column - 1 if is_beyond else column
        held[part % 2] = held_before + before[limits[part + 1]]
    limits[count] = len(before) - 1
    return limits


@njit(cache=True)
@named(CORE_MARK)
def _counting_sort(places, low, extents, origin, cell_size, offset, narrowest):  # type: ignore[no-untyped-def]
    axes, count, cells = places.shape[0], places.shape[1], 1
    for axis in range(axes):
        cells *= extents[axis]
    keys = np.empty(count, np.int32)
    starts = np.zeros(cells + 1, np.int64)
    for p in range(count):
        key = 0
        for axis in range(axes):
            key = key * extents[axis] + first_node(places[axis, p], origin[axis], cell_size, offset) - low[axis]
        keys[p] = key
        starts[key + 1] += 1
    for key in range(cells):
        starts[key + 1] += starts[key]
    stripe_starts = _stripe_starts(starts[:: cells // extents[0]].copy(), narrowest)
    order = np.empty(count, np.int32)
    for p in range(count):
        order[starts[keys[p]]] = p
        starts[keys[p]] += 1
    return order, stripe_starts


def reorder(storage: NDArray[np.float64], ids: NDArray[np.int32], first: int, order: NDArray[np.int32]) -> None:
    """Bring points and their ids, from the first of them on, into an order that is counted from there."""
    _reorder(storage, first, order)
    _reorder(ids[np.newaxis], first, order)


@njit(parallel=True, cache=True)
@named(CORE_MARK)
def _reorder(rows, first, order):  # type: ignore[no-untyped-def]
    for number in prange(rows.shape[0]):
        row, found = rows[number, first : first + len(order)], np.empty(len(order), rows.dtype)
        for p in range(len(order)):
            # unsigned, so that nothing is done for numbers that count from the end
            found[p] = row[np.uint64(order[p])]
        row[:] = found
