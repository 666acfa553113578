"""For how long idle threads stay awake between the passes of a step.

OpenMP's threads count turns of a loop before they sleep, and a turn takes several times as long on some processors as
on others. It is therefore timed.
"""

import platform
import time
from typing import Any

import numpy as np
from llvmlite import ir
from numba import njit
from numba.core import types
from numba.core.cgutils import get_or_insert_function
from numba.extending import intrinsic

# About twice as long as a step has no work for a second thread [s]. A thread that sleeps takes longer than that to wake
# up; one that stays awake takes the time of other work on the machine.
AWAKE = 60e-6

_HAS_PAUSE = platform.machine().lower() in ("x86_64", "amd64")
_TURNS, _TRIALS = 2000, 5


@intrinsic
def _turn(typing_context: Any, flag: Any) -> Any:
    """What GNU's OpenMP does in a turn: look at a flag, and pause where the processor can."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        if _HAS_PAUSE:
            pause = ir.FunctionType(ir.VoidType(), [])
            builder.call(get_or_insert_function(builder.module, pause, "llvm.x86.sse2.pause"), [])
        flags = context.make_array(signature.args[0])(context, builder, arguments[0])
        return builder.load_atomic(flags.data, "acquire", align=8)

    return types.int64(flag), generate


@njit(cache=True)
def _take_turns(flag, turns):  # type: ignore[no-untyped-def]
    for _ in range(turns):
        if _turn(flag) != 0:  # type: ignore[call-arg]
            break


def turns_awake() -> int:
    """How many turns take about as long as threads are to stay awake."""
    flag = np.zeros(1, np.int64)
    _take_turns(flag, 1)
    return round(AWAKE * _TURNS / min(_duration(flag) for _ in range(_TRIALS)))


def _duration(flag: Any) -> float:
    started = time.perf_counter()
    _take_turns(flag, _TURNS)
    return time.perf_counter() - started
