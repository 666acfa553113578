"""The mark that lets a plain function of scalars be called from a compiled law.

Marking does not import the compiler: a marked function stays plain Python until a law is compiled, so that listing laws
and debugging them costs no start-up time.
"""

from collections.abc import Callable
from typing import TypeVar

Function = TypeVar("Function", bound=Callable[..., object])

MARKED: list[Callable[..., object]] = []


def pointwise(function: Function) -> Function:
    """Mark a helper (scalars and NamedTuples in and out, `math` only) as callable from a law's functions."""
    MARKED.append(function)
    return function
