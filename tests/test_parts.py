"""Parts of a pass are done once each, by whichever thread comes for them first."""

import numpy as np
import pytest
from numba import njit, prange

from grainlaw.mpm_core.parallel.threads import cores, use_threads
from grainlaw.mpm_core.parallel.work_sharing import chunk_ranges, next_chunk, threads_of


@njit
def taken_in_turn(parts, threads, turns):
    """The parts that threads get which come in this order."""
    shares = chunk_ranges(parts, threads)
    return [next_chunk(shares, thread) for thread in turns]


@njit(parallel=True)
def times_taken(parts, threads):
    """How often each part is taken by threads that work at once, the first more slowly than the others."""
    shares, times, waste = chunk_ranges(parts, threads), np.zeros(parts, np.int64), np.zeros(threads)
    for thread in prange(threads_of(shares)):
        part = next_chunk(shares, thread)
        while part >= 0:
            times[part] += 1
            for _ in range(1 if thread > 0 else 3):
                waste[thread] = np.sin(waste[thread] + part)
            part = next_chunk(shares, thread)
    return times


def test_a_thread_takes_its_own_share_and_then_what_others_have_left():
    assert taken_in_turn(7, 2, np.array([0, 1, 0, 0, 0, 0, 1, 0, 1])) == [0, 3, 1, 2, 4, 5, 6, -1, -1]


def test_the_last_thread_goes_on_with_the_share_of_the_first():
    assert taken_in_turn(6, 3, np.array([2, 2, 2, 2, 2, 0, 1])) == [4, 5, 0, 1, 2, 3, -1]


@pytest.mark.parametrize("parts", [0, 1, 3])
def test_threads_without_a_part_get_none(parts):
    assert taken_in_turn(parts, 4, np.array([0, 0, 0, 0, 1])) == [*range(parts), *[-1] * (5 - parts)]


@pytest.mark.skipif(cores() < 2, reason="needs two cores")
def test_threads_that_come_for_parts_at_once_take_each_of_them_once():
    use_threads(2)
    for _ in range(200):
        assert (times_taken(100, 2) == 1).all()
