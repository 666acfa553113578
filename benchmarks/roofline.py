"""What one core of this machine can do: bandwidth of a triad over the size of its arrays, and rate of multiply-adds."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numba import njit

from benchmarks.timing import timed
from grainlaw.materials.compilation import mark_of_sources, named
from grainlaw.materials.elementary import fused
from grainlaw.materials.precision import PRECISIONS

REPEATS = 7
LEAST_WORK = 2e8
CHAIN = 16
L1_BYTES = 8192
# `fused` is compiled as `materials` says.
MARK = mark_of_sources(())


@dataclass(frozen=True)
class Roofline:
    """Bandwidth [bytes/s] by working set [bytes], arithmetic rate [1/s] by precision; a multiply-add counts as two."""

    bandwidths: dict[int, float]
    arithmetic_rates: dict[str, float]

    def bandwidth(self, working_set: float) -> float:
        """Of a working set of this many bytes, between those measured."""
        sizes = sorted(self.bandwidths)
        return float(np.interp(np.log(working_set), np.log(sizes), [self.bandwidths[size] for size in sizes]))


@njit(cache=True)
@named(MARK)
def _triad(a, b, c, factor, rounds):  # type: ignore[no-untyped-def]
    for _ in range(rounds):
        for i in range(len(a)):
            a[i] = fused(factor, c[i], b[i])


@njit(cache=True)
@named(MARK)
def _multiply_adds(x, factor, summand, rounds):  # type: ignore[no-untyped-def]
    for _ in range(rounds):
        for i in range(len(x)):
            value = x[i]
            for _unrolled in range(CHAIN):
                value = fused(value, factor, summand)
            x[i] = value


def triad_bandwidth(working_set: int) -> float:
    """Bytes/s of processor time of a = b + factor c, two reads and one write, best of several.

    `working_set` is that of all three [bytes].
    """
    length = working_set // 24
    a, b, c = np.zeros(length), np.ones(length), np.ones(length)
    rounds = max(1, int(LEAST_WORK / (24 * length)))
    _triad(a, b, c, 0.5, 1)
    return 24 * length * rounds / min(timed(lambda: _triad(a, b, c, 0.5, rounds)).cpu for _ in range(REPEATS))


def arithmetic_rate(precision: str) -> float:
    """Operations/s of independent chains of multiply-adds on data in the first cache, best of several."""
    number = PRECISIONS[precision]
    x, factor, summand = np.ones(L1_BYTES // np.dtype(number).itemsize, number), number(0.999), number(0.001)
    rounds = int(LEAST_WORK / (2 * CHAIN * len(x)))
    _multiply_adds(x, factor, summand, 1)
    best = min(timed(lambda: _multiply_adds(x, factor, summand, rounds)).cpu for _ in range(REPEATS))
    return 2 * CHAIN * len(x) * rounds / best


def measured_roofline(working_sets: Iterable[int]) -> Roofline:
    """Measure all; the largest working set should exceed the last cache."""
    bandwidths = {size: triad_bandwidth(size) for size in working_sets}
    return Roofline(bandwidths, {precision: arithmetic_rate(precision) for precision in PRECISIONS})
