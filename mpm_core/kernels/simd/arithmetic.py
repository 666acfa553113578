"""Arithmetic of numbers side by side in a register (`lanes`), written as that of scalars.

Numbers beside lanes are taken for as many of them, of their kind.
"""

import functools
import math
import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.cgutils import get_or_insert_function
from numba.extending import intrinsic, overload, register_jitable

from grainlaw.mpm_core.kernels.simd.registers import INDEX, SCALARS, LanesType, converted, shuffled, vector_of


def _in_all_lanes(builder: Any, scalar: Any, kind: LanesType) -> Any:
    vector, number = vector_of(kind), SCALARS[kind.number][0]
    undefined = ir.Constant(vector, ir.Undefined)
    if scalar.type != number:
        scalar = builder.fptrunc(scalar, number)
    first = builder.insert_element(undefined, scalar, ir.Constant(INDEX, 0))
    return shuffled(builder, first, undefined, [0] * kind.count)


def _call(builder: Any, name: str, *arguments: Any) -> Any:
    """Call a function of the compiler's that works lane by lane, on vectors."""
    vector = arguments[0].type
    number = next(found for scalar, found, _ in SCALARS.values() if scalar == vector.element)
    function_type = ir.FunctionType(vector, [vector] * len(arguments))
    whole_name = f"llvm.{name}.v{vector.count}{number}"
    return builder.call(get_or_insert_function(builder.module, function_type, whole_name), arguments)


@intrinsic
def _filled(typing_context: Any, scalar: Any, like: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _in_all_lanes(builder, arguments[0], like)

    return like(types.float64, like), generate


def _turned_into(number: Any) -> Any:
    """The nearest numbers of a kind."""

    @intrinsic
    def function(typing_context: Any, lanes: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return converted(builder, arguments[0], number)

        return LanesType(number, lanes.count)(lanes), generate

    return function


_widened = _turned_into(types.float64)
_narrowed = _turned_into(types.float32)


@intrinsic
def _fused(typing_context: Any, factor: Any, a: Any, b: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _call(builder, "fma", *arguments)

    return a(a, a, a), generate


@intrinsic
def _first_lanes(typing_context: Any, lanes: Any, count: Any, otherwise: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        found, count, otherwise = arguments
        numbers = ir.Constant(vector_of(lanes), [float(number) for number in range(lanes.count)])
        inside = builder.fcmp_ordered("<", numbers, _in_all_lanes(builder, count, lanes))
        return builder.select(inside, found, _in_all_lanes(builder, otherwise, lanes))

    return lanes(lanes, types.float64, types.float64), generate


def _by_lanes(name: str) -> Any:
    """A function of the compiler's in each lane."""

    @intrinsic
    def function(typing_context: Any, lanes: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return _call(builder, name, *arguments)

        return lanes(lanes), generate

    return function


_truncated = _by_lanes("trunc")
_square_root = _by_lanes("sqrt")


@intrinsic
def _where_equal(typing_context: Any, a: Any, b: Any, then: Any, otherwise: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        a, b, then, otherwise = arguments
        return builder.select(builder.fcmp_ordered("==", a, b), then, otherwise)

    return then(a, a, then, then), generate


@intrinsic
def _some_equal(typing_context: Any, a: Any, b: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        bits = builder.bitcast(builder.fcmp_ordered("==", *arguments), ir.IntType(a.count))
        return builder.icmp_unsigned("!=", bits, ir.Constant(ir.IntType(a.count), 0))

    return types.boolean(a, a), generate


def _smaller_of(builder: Any, a: Any, b: Any) -> Any:
    return builder.select(builder.fcmp_ordered("<", b, a), b, a)


def _larger_of(builder: Any, a: Any, b: Any) -> Any:
    return builder.select(builder.fcmp_ordered(">", b, a), b, a)


def _reduced(build: Callable[[Any, Any, Any], Any]) -> Any:
    """One number from the lanes, taken in their order."""

    @intrinsic
    def reduction(typing_context: Any, lanes: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            numbers = [builder.extract_element(arguments[0], ir.Constant(INDEX, k)) for k in range(lanes.count)]
            return functools.reduce(lambda a, b: build(builder, a, b), numbers)

        return lanes.number(lanes), generate

    return reduction


def _arithmetic(build: Callable[[Any, Any, Any], Any]) -> Any:
    """An operation of two in each lane."""

    @intrinsic
    def operation(typing_context: Any, a: Any, b: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return build(builder, *arguments)

        return a(a, a), generate

    return operation


_added = _arithmetic(lambda builder, a, b: builder.fadd(a, b))
_subtracted = _arithmetic(lambda builder, a, b: builder.fsub(a, b))
_multiplied = _arithmetic(lambda builder, a, b: builder.fmul(a, b))
_divided = _arithmetic(lambda builder, a, b: builder.fdiv(a, b))
_lesser = _arithmetic(_smaller_of)
_greater = _arithmetic(_larger_of)


def _are_lanes(*values: Any) -> bool:
    return any(isinstance(value, LanesType) for value in values)


def as_lanes(a: Any, like: Any) -> Any:
    """Lanes as they are, or a number in all lanes, as many as there are in `like`; for compiled code."""
    raise NotImplementedError


@overload(as_lanes)
def _choose_as_lanes(a, like):  # type: ignore[no-untyped-def]
    if isinstance(a, LanesType):
        return lambda a, like: a
    return lambda a, like: _filled(float(a), like)  # type: ignore[call-arg]


def _operator(symbol: Callable[..., Any], operation: Any) -> None:
    """Let an operator take lanes, and lanes with a number on either side."""

    @overload(symbol)
    def chosen(a, b):  # type: ignore[no-untyped-def]
        if _are_lanes(a, b):
            return lambda a, b: operation(as_lanes(a, b), as_lanes(b, a))
        return None


for _symbol, _operation in (
    (operator.add, _added),
    (operator.sub, _subtracted),
    (operator.mul, _multiplied),
    (operator.truediv, _divided),
):
    _operator(_symbol, _operation)

_total = _reduced(lambda builder, a, b: builder.fadd(a, b))
_smallest = _reduced(_smaller_of)
_largest = _reduced(_larger_of)


# As in `lanes`, closures hold what hands on, not the intrinsics.


@register_jitable(forceinline=True)
def filled_like(number: float, like: Any) -> Any:
    """A number in all lanes, of the kind of others."""
    return _filled(number, like)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def widened(lanes: Any) -> Any:
    """The same numbers as doubles."""
    return _widened(lanes)


@register_jitable(forceinline=True)
def narrowed(lanes: Any) -> Any:
    """The nearest singles."""
    return _narrowed(lanes)


@register_jitable(forceinline=True)
def unchanged(lanes: Any) -> Any:
    """The same numbers."""
    return lanes


def rounding_to(precision: str) -> Callable[..., Any]:
    """The function that turns doubles into numbers of a precision."""
    return narrowed if precision == "single" else unchanged


@register_jitable(forceinline=True)
def scaled_sum(factor: Any, a: Any, b: Any) -> Any:
    """Return factor * a + b, rounded once; the factor may be a number."""
    return _fused(as_lanes(factor, a), a, b)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def first_lanes(lanes: Any, count: float, otherwise: float) -> Any:
    """The first lanes, and another number in the rest."""
    return _first_lanes(lanes, count, otherwise)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def total(lanes: Any) -> Any:
    """The sum of the numbers."""
    return _total(lanes)


@register_jitable(forceinline=True)
def smallest(lanes: Any) -> Any:
    """The smallest of the numbers."""
    return _smallest(lanes)


@register_jitable(forceinline=True)
def largest(lanes: Any) -> Any:
    """The largest of the numbers."""
    return _largest(lanes)


def truncated(a: Any) -> Any:
    """A number, or each lane, without what follows the point."""
    return math.trunc(a)


def lesser(a: Any, b: Any) -> Any:
    """The smaller of two numbers, or in each lane, a where b is not a number."""
    return b if b < a else a


def greater(a: Any, b: Any) -> Any:
    """The larger of two numbers, or in each lane, a where b is not a number."""
    return b if b > a else a


def where_equal(a: Any, b: Any, then: Any, otherwise: Any) -> Any:
    """`then` where a = b, for numbers or in each lane."""
    return then if a == b else otherwise


def some_equal(a: Any, b: Any) -> Any:
    """Whether a = b, in any lane."""
    return a == b


@overload(truncated)
def _choose_truncated(a):  # type: ignore[no-untyped-def]
    if _are_lanes(a):
        return lambda a: _truncated(a)  # noqa: PLW0108
    return lambda a: math.floor(a) if a > 0.0 else math.ceil(a)


@overload(math.sqrt)
def _choose_square_root(x):  # type: ignore[no-untyped-def]
    if _are_lanes(x):
        return lambda x: _square_root(x)  # noqa: PLW0108
    return None


@overload(lesser)
def _choose_lesser(a, b):  # type: ignore[no-untyped-def]
    if _are_lanes(a, b):
        return lambda a, b: _lesser(as_lanes(a, b), as_lanes(b, a))
    return lambda a, b: b if b < a else a


@overload(greater)
def _choose_greater(a, b):  # type: ignore[no-untyped-def]
    if _are_lanes(a, b):
        return lambda a, b: _greater(as_lanes(a, b), as_lanes(b, a))
    return lambda a, b: b if b > a else a


@overload(where_equal)
def _choose_where_equal(a, b, then, otherwise):  # type: ignore[no-untyped-def]
    if not _are_lanes(a):
        return lambda a, b, then, otherwise: then if a == b else otherwise
    return lambda a, b, then, otherwise: _where_equal(  # type: ignore[call-arg]
        a, as_lanes(b, a), as_lanes(then, otherwise), as_lanes(otherwise, then)
    )


@overload(some_equal)
def _choose_some_equal(a, b):  # type: ignore[no-untyped-def]
    if _are_lanes(a, b):
        return lambda a, b: _some_equal(as_lanes(a, b), as_lanes(b, a))  # type: ignore[call-arg]
    return lambda a, b: a == b
