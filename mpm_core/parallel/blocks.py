"""How a pass over points is divided: into blocks that threads work through and report of, each by itself.

The blocks follow from the number of points alone, so that the sums over them come out the same for any number of
threads.
"""

from numba.extending import register_jitable

from grainlaw.mpm_core.kernels.simd.registers import MOST_AT_ONCE

# Points of a block, at most.
BLOCK = 2048
# Blocks come in as many, so that two or four threads have equal ranges.
EQUAL_SHARES = 4


def blocks_of(points: int) -> int:
    """How many blocks so many points have."""
    if points <= BLOCK:
        return min(points, 1)
    return EQUAL_SHARES * -(-points // (EQUAL_SHARES * BLOCK))


@register_jitable
def points_of_block(block, blocks, count):  # type: ignore[no-untyped-def]
    """First point of a block, and the one behind its last; all blocks are equally long, in whole registers."""
    length = MOST_AT_ONCE * ((count + blocks * MOST_AT_ONCE - 1) // (blocks * MOST_AT_ONCE))
    return min(block * length, count), min((block + 1) * length, count)
