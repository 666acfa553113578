"""Points in stripes: of one parity no two share a node, and two threads have equal shares of each."""

from itertools import pairwise

import numpy as np
import pytest

from grainlaw.mpm_core.kernels.shape_functions import BASES
from grainlaw.mpm_core.parallel.blocks import EQUAL_SHARES
from grainlaw.mpm_core.parallel.sorting import sort_by_stencil

CELL = 0.1
# Heights [cells] of a pile over the column of cells, of some number of columns.
PILES = {
    "column": np.full(48, 30),
    "cone": np.concatenate([np.arange(1, 41), np.arange(40, 0, -1)]),
    "tall with a thin deposit": np.concatenate([np.full(12, 60), np.ones(150, int)]),
    "two heaps": np.concatenate([np.full(20, 10), np.zeros(30, int), np.full(17, 25)]),
    "four columns": np.full(4, 20),
    "one column": np.full(1, 20),
}


def points_of(heights):
    """Two by two points in each cell, in no order."""
    cells = [(i, j) for i, height in enumerate(heights) for j in range(height)]
    places = [(i + a, j + b) for i, j in cells for a in (0.25, 0.75) for b in (0.25, 0.75)]
    return CELL * np.random.default_rng(1).permutation(places).T


def stripes_of(heights, basis):
    """The columns of the first nodes of the points of each stripe."""
    points = points_of(heights)
    order, starts = sort_by_stencil(points, (0.0, 0.0), CELL, basis)
    assert sorted(order) == list(range(points.shape[1]))
    first_nodes = np.floor(points[0, order] / CELL - basis.offset).astype(int)
    return np.split(first_nodes, starts[1:-1]), starts


@pytest.mark.parametrize("basis", BASES.values(), ids=BASES.keys())
@pytest.mark.parametrize("pile", PILES)
def test_stripes_of_one_parity_share_no_node_when_points_have_drifted_by_a_cell(pile, basis):
    stripes, _ = stripes_of(PILES[pile], basis)
    assert len(np.concatenate(stripes)) == 4 * PILES[pile].sum()
    for parity in (0, 1):
        held = [stripe for stripe in stripes[parity::2] if len(stripe) > 0]
        for left, right in pairwise(held):
            assert left.max() + 1 + basis.width - 1 < right.min() - 1


@pytest.mark.parametrize("pile", ["column", "cone", "two heaps"])
def test_two_threads_have_equal_shares_of_each_parity(pile):
    heights = PILES[pile]
    _, starts = stripes_of(heights, BASES["quadratic"])
    counts, tallest = np.diff(starts), 4 * heights.max()
    assert len(counts) % EQUAL_SHARES == 0
    for parity in (0, 1):
        first, second = (half.sum() for half in np.split(counts[parity::2], 2))
        assert abs(int(first) - int(second)) <= tallest
