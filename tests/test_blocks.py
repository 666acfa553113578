import numpy as np
import pytest

from grainlaw.mpm_core.kernels.simd.registers import MOST_AT_ONCE
from grainlaw.mpm_core.parallel.blocks import BLOCK, EQUAL_SHARES, blocks_of, points_of_block

COUNTS = [0, 1, 3, 108, BLOCK, BLOCK + 1, 10_800, 27_648, 97_200, 1_000_003]


@pytest.mark.parametrize("count", COUNTS)
def test_blocks_take_each_point_once_and_begin_with_whole_registers(count):
    blocks = blocks_of(count)
    bounds = [points_of_block(block, blocks, count) for block in range(blocks)]
    assert [begin for begin, _ in bounds] == [0, *(end for _, end in bounds[:-1])][:blocks]
    assert (bounds[-1][1] if bounds else 0) == count
    assert all(begin % MOST_AT_ONCE == 0 and end - begin <= BLOCK for begin, end in bounds if begin < count)


@pytest.mark.parametrize("count", [count for count in COUNTS if count > BLOCK])
@pytest.mark.parametrize("threads", [2, 4])
def test_threads_have_equal_shares(count, threads):
    blocks = blocks_of(count)
    each = blocks // threads
    ends = [0, *(points_of_block(each * (thread + 1) - 1, blocks, count)[1] for thread in range(threads))]
    assert blocks % EQUAL_SHARES == 0
    assert max(np.diff(ends)) <= count / threads + MOST_AT_ONCE * each
