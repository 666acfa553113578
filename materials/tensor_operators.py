"""The operators of `SymmetricTensor` in compiled code: a + b, a - b, -a, x a, a x and a/x with a number x.

The compiler knows none for NamedTuples. Whatever is not listed here, such as a tensor and a tuple, does not compile.
"""

import operator
from collections.abc import Callable
from typing import Any

from numba import types
from numba.extending import overload

from grainlaw.materials.tensor import SymmetricTensor, added, difference, divided, negative, scaled


def _is_tensor(kind: Any) -> bool:
    return isinstance(kind, types.BaseNamedTuple) and getattr(kind, "instance_class", None) is SymmetricTensor


def _is_number(kind: Any) -> bool:
    return isinstance(kind, types.Number)


def _overload(of: Callable[..., Any]) -> Callable[..., Any]:
    return overload(of, jit_options={"forceinline": True})


@_overload(operator.add)
def _add(a, b):  # type: ignore[no-untyped-def]
    return (lambda a, b: added(a, b)) if _is_tensor(a) and _is_tensor(b) else None  # noqa: PLW0108


@_overload(operator.sub)
def _subtract(a, b):  # type: ignore[no-untyped-def]
    return (lambda a, b: difference(a, b)) if _is_tensor(a) and _is_tensor(b) else None  # noqa: PLW0108


@_overload(operator.neg)
def _negate(a):  # type: ignore[no-untyped-def]
    return (lambda a: negative(a)) if _is_tensor(a) else None  # noqa: PLW0108


@_overload(operator.mul)
def _multiply(a, b):  # type: ignore[no-untyped-def]
    if _is_tensor(a) and _is_number(b):
        return lambda a, b: scaled(a, b)  # noqa: PLW0108
    return (lambda a, b: scaled(b, a)) if _is_number(a) and _is_tensor(b) else None


@_overload(operator.truediv)
def _divide(a, b):  # type: ignore[no-untyped-def]
    return (lambda a, b: divided(a, b)) if _is_tensor(a) and _is_number(b) else None  # noqa: PLW0108
