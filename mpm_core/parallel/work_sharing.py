"""How threads share the chunks of a pass: each begins with a share of its own, and who has finished helps the others.

A thread whose core is slower, or whose points take longer, then keeps nobody waiting. Parts do not depend on one
another, and what comes of them does not depend on who does them.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic, register_jitable

# Of the work of a thread: the next chunk, and the one behind its last. The rest of the row keeps those of two threads
# out of one cache line.
NEXT, END = 0, 1
STRIDE = 16


@intrinsic
def _taken(typing_context: Any, array: Any, position: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        numbers = context.make_array(signature.args[0])(context, builder, arguments[0])
        pointer = builder.gep(numbers.data, [arguments[1]])
        return builder.atomic_rmw("add", pointer, ir.Constant(ir.IntType(64), 1), "seq_cst")

    return types.int64(array, types.intp), generate


@register_jitable
def chunk_ranges(chunks, threads):  # type: ignore[no-untyped-def]
    """The chunks from zero on, shared between threads."""
    ranges = np.zeros(threads * STRIDE, np.int64)
    for thread in range(threads):
        ranges[thread * STRIDE + NEXT] = chunks * thread // threads
        ranges[thread * STRIDE + END] = chunks * (thread + 1) // threads
    return ranges


@register_jitable
def threads_of(ranges):  # type: ignore[no-untyped-def]
    """How many threads there are ranges for."""
    return len(ranges) // STRIDE


@register_jitable
def next_chunk(ranges, thread):  # type: ignore[no-untyped-def]
    """The next chunk for a thread: of its own share, else of another's; -1 where nothing is left."""
    threads = threads_of(ranges)
    for turn in range(threads):
        share = (thread + turn) % threads * STRIDE
        if ranges[share + NEXT] < ranges[share + END]:
            chunk = _taken(ranges, share + NEXT)  # type: ignore[call-arg, var-annotated]
            if chunk < ranges[share + END]:
                return chunk
    return -1
