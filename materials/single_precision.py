"""The same functions for numbers in single precision.

A law is written with plain numbers, which the compiler takes for doubles: half of a single would be a double again. A
version of a function in single precision has the same code and every number that stands in it, and what it calls has
too. The compiler then takes twice as many points at once, and roots and divisions cost a third.
"""

import inspect
from collections.abc import Callable
from types import CellType, FunctionType
from typing import Any

import numpy as np
from numba.extending import register_jitable

from grainlaw.materials.pointwise import MARKED

# Functions of the core that are compiled as `register_jitable` does, and of which there may be a version in singles.
_ADAPTABLE: set[Callable[..., Any]] = set()
_FOUND: dict[Callable[..., Any], Callable[..., Any]] = {}


def adaptable(function: Callable[..., Any]) -> Callable[..., Any]:
    """Register a function with the compiler, like `register_jitable`, and let it have a version in single precision."""
    _ADAPTABLE.add(function)
    return register_jitable(function)


def in_single(function: Callable[..., Any]) -> Callable[..., Any]:
    """The version in single precision of a function, registered with the compiler; one for all callers."""
    if function not in _FOUND:
        register = register_jitable(forceinline=function not in _ADAPTABLE)
        _FOUND[function] = register(_adapted(function))
    return _FOUND[function]


def in_precision(function: Callable[..., Any], precision: str) -> Callable[..., Any]:
    """An adaptable function as it is, or its version in single precision."""
    return in_single(function) if precision == "single" else function


def nearest_single(number: float) -> Any:
    """The single nearest to a number, but none that is zero for a number that is not."""
    single = np.float32(number)
    return single if single != 0.0 or number == 0.0 else np.finfo(np.float32).tiny


def _adapted(function: Callable[..., Any]) -> Callable[..., Any]:
    code, known = function.__code__, function.__globals__
    called = {name: _value(known[name]) for name in code.co_names if name in known}
    cells = function.__closure__ or ()
    adapted = FunctionType(
        code.replace(co_consts=tuple(map(_value, code.co_consts))),
        {**known, **called},
        f"{function.__name__}_in_single",
        function.__defaults__,
        tuple(CellType(_value(cell.cell_contents)) for cell in cells) or None,
    )
    adapted.__qualname__ = f"{function.__qualname__}_in_single"
    adapted.__module__ = function.__module__
    return adapted


def _value(value: Any) -> Any:
    """What stands for a constant, a global or a value of a closure."""
    if isinstance(value, float):
        return nearest_single(value)
    if type(value) is tuple:
        return tuple(map(_value, value))
    if inspect.isfunction(value) and (value in MARKED or value in _ADAPTABLE):
        return in_single(value)
    return value
