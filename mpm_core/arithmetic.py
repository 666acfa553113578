"""Fused multiply-add for compiled code.

Written out, it is the same on every machine and in every compilation; a licence for the compiler to fuse where it likes
(`fastmath`) is not, and runs would no longer repeat bit for bit.
"""

from typing import Any

from numba.core import types
from numba.extending import intrinsic, register_jitable


@intrinsic
def _fused(typing_context: Any, a: Any, b: Any, c: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), generate


@register_jitable
def fma(a: float, b: float, c: float) -> float:
    """Return a b + c, rounded once."""
    return _fused(a, b, c)  # type: ignore[call-arg]
