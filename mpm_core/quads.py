"""Four doubles side by side in a vector register, for compiled code; arrays may also hold them as singles.

The transfers use them in two ways: as one quantity of four neighbouring points, which are then worked on together, and
as four components of one grid node, which a point changes together. `transposed` leads from one to the other.

Arithmetic is written as for scalars. Each lane is rounded like the scalar expression would be, so that the width of
the machine's registers changes the time, not the result.
"""

import functools
import math
import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.cgutils import get_or_insert_function
from numba.core.datamodel.models import PrimitiveModel
from numba.extending import intrinsic, overload, register_jitable, register_model

LANES = 4

_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
_INDEX = ir.IntType(32)
_UNDEFINED = ir.Constant(_VECTOR, ir.Undefined)
# What arrays hold, and its size. No alignment of a whole vector is asked for.
_STORED = {types.float64: (ir.DoubleType(), 8), types.float32: (ir.FloatType(), 4)}


class QuadType(types.Type):
    """The compiler's type of four doubles in a register."""

    def __init__(self) -> None:
        super().__init__(name="Quad")


QUAD = QuadType()


@register_model(QuadType)
class _QuadModel(PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _VECTOR)


def _shuffled(builder: Any, a: Any, b: Any, lanes: list[int]) -> Any:
    return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(_INDEX, LANES), lanes))


def _in_all_lanes(builder: Any, scalar: Any) -> Any:
    first = builder.insert_element(_UNDEFINED, scalar, ir.Constant(_INDEX, 0))
    return _shuffled(builder, first, _UNDEFINED, [0] * LANES)


def place(context: Any, builder: Any, array_type: Any, arguments: Any, lanes: int) -> tuple[Any, int]:
    """Pointer to so many lanes of an array from a position on, and the alignment of a lane."""
    array = context.make_array(array_type)(context, builder, arguments[0])
    scalar, size = _STORED[array_type.dtype]
    vector = ir.VectorType(scalar, lanes)
    return builder.bitcast(builder.gep(array.data, [arguments[1]]), vector.as_pointer()), size


@intrinsic
def _quad_at(typing_context: Any, array: Any, position: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, alignment = place(context, builder, signature.args[0], arguments, LANES)
        stored = builder.load(pointer, align=alignment)
        return stored if stored.type == _VECTOR else builder.fpext(stored, _VECTOR)

    return QUAD(array, position), generate


@intrinsic
def _put_quad(typing_context: Any, array: Any, position: Any, quad: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, alignment = place(context, builder, signature.args[0], arguments, LANES)
        vector = pointer.type.pointee
        rounded = arguments[2] if vector == _VECTOR else builder.fptrunc(arguments[2], vector)
        builder.store(rounded, pointer, align=alignment)
        return context.get_dummy_value()

    return types.void(array, position, QUAD), generate


@intrinsic
def _filled(typing_context: Any, scalar: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _in_all_lanes(builder, arguments[0])

    return QUAD(types.float64), generate


@intrinsic
def _fused(typing_context: Any, factor: Any, a: Any, b: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        fma = get_or_insert_function(builder.module, ir.FunctionType(_VECTOR, [_VECTOR] * 3), f"llvm.fma.v{LANES}f64")
        return builder.call(fma, arguments)

    return QUAD(QUAD, QUAD, QUAD), generate


@intrinsic
def _transposed(typing_context: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    result = types.UniTuple(QUAD, LANES)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        a, b, c, d = arguments
        low_ab, high_ab = _shuffled(builder, a, b, [0, 4, 2, 6]), _shuffled(builder, a, b, [1, 5, 3, 7])
        low_cd, high_cd = _shuffled(builder, c, d, [0, 4, 2, 6]), _shuffled(builder, c, d, [1, 5, 3, 7])
        rows = [
            _shuffled(builder, low_ab, low_cd, [0, 1, 4, 5]),
            _shuffled(builder, high_ab, high_cd, [0, 1, 4, 5]),
            _shuffled(builder, low_ab, low_cd, [2, 3, 6, 7]),
            _shuffled(builder, high_ab, high_cd, [2, 3, 6, 7]),
        ]
        return context.make_tuple(builder, result, rows)

    return result(QUAD, QUAD, QUAD, QUAD), generate


@intrinsic
def _halves_swapped(typing_context: Any, quad: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _shuffled(builder, arguments[0], arguments[0], [2, 3, 0, 1])

    return QUAD(QUAD), generate


@intrinsic
def _halves_joined(typing_context: Any, a: Any, b: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _shuffled(builder, arguments[0], arguments[1], [0, 1, 6, 7])

    return QUAD(QUAD, QUAD), generate


@intrinsic
def _first_lanes(typing_context: Any, quad: Any, count: Any, otherwise: Any) -> Any:
    numbers = ir.Constant(_VECTOR, [float(number) for number in range(LANES)])

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        quad, count, otherwise = arguments
        inside = builder.fcmp_ordered("<", numbers, _in_all_lanes(builder, count))
        return builder.select(inside, quad, _in_all_lanes(builder, otherwise))

    return QUAD(QUAD, types.float64, types.float64), generate


def _by_lanes(name: str) -> Any:
    """A function of the compiler's in each lane."""

    @intrinsic
    def function(typing_context: Any, quad: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            whole_name = f"llvm.{name}.v{LANES}f64"
            found = get_or_insert_function(builder.module, ir.FunctionType(_VECTOR, [_VECTOR]), whole_name)
            return builder.call(found, [arguments[0]])

        return QUAD(QUAD), generate

    return function


_truncated = _by_lanes("trunc")
_square_root = _by_lanes("sqrt")


@intrinsic
def _where_equal(typing_context: Any, a: Any, b: Any, then: Any, otherwise: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        a, b, then, otherwise = arguments
        return builder.select(builder.fcmp_ordered("==", a, b), then, otherwise)

    return QUAD(QUAD, QUAD, QUAD, QUAD), generate


@intrinsic
def _some_equal(typing_context: Any, a: Any, b: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        equal = builder.fcmp_ordered("==", arguments[0], arguments[1])
        bits = builder.bitcast(equal, ir.IntType(LANES))
        return builder.icmp_unsigned("!=", bits, ir.Constant(ir.IntType(LANES), 0))

    return types.boolean(QUAD, QUAD), generate


def _smaller_of(builder: Any, a: Any, b: Any) -> Any:
    return builder.select(builder.fcmp_ordered("<", b, a), b, a)


def _larger_of(builder: Any, a: Any, b: Any) -> Any:
    return builder.select(builder.fcmp_ordered(">", b, a), b, a)


def _reduced(build: Callable[[Any, Any, Any], Any]) -> Any:
    """One number from the lanes of a quad, taken in their order."""

    @intrinsic
    def reduction(typing_context: Any, quad: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            numbers = [builder.extract_element(arguments[0], ir.Constant(_INDEX, k)) for k in range(LANES)]
            return functools.reduce(lambda a, b: build(builder, a, b), numbers)

        return types.float64(QUAD), generate

    return reduction


def _arithmetic(build: Callable[[Any, Any, Any], Any]) -> Any:
    """An operation of two quads in each lane."""

    @intrinsic
    def operation(typing_context: Any, a: Any, b: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return build(builder, arguments[0], arguments[1])

        return QUAD(QUAD, QUAD), generate

    return operation


_added = _arithmetic(lambda builder, a, b: builder.fadd(a, b))
_subtracted = _arithmetic(lambda builder, a, b: builder.fsub(a, b))
_multiplied = _arithmetic(lambda builder, a, b: builder.fmul(a, b))
_divided = _arithmetic(lambda builder, a, b: builder.fdiv(a, b))
_lesser = _arithmetic(_smaller_of)
_greater = _arithmetic(_larger_of)


def as_quad(a: Any) -> Any:
    """A quad as it is, or a quad of a number; for compiled code."""
    raise NotImplementedError


@overload(as_quad)
def _choose_as_quad(a):  # type: ignore[no-untyped-def]
    if isinstance(a, QuadType):
        return lambda a: a
    return lambda a: _filled(float(a))  # type: ignore[call-arg]


def _operator(symbol: Callable[..., Any], operation: Any) -> None:
    """Let an operator take quads, and a quad with a number on either side."""

    @overload(symbol)
    def chosen(a, b):  # type: ignore[no-untyped-def]
        if isinstance(a, QuadType) or isinstance(b, QuadType):
            return lambda a, b: operation(as_quad(a), as_quad(b))
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


# What follows hands on, so that closures over it have the same mark in every process: that of an intrinsic is random,
# and a kernel with one in its closure would be compiled again by each.


@register_jitable(forceinline=True)
def quad_at(array: Any, position: Any) -> Any:
    """The four numbers from a position on."""
    return _quad_at(array, position)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def put_quad(array: Any, position: Any, quad: Any) -> None:
    """Store four numbers from a position on."""
    _put_quad(array, position, quad)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def filled(number: float) -> Any:
    """A quad of a number."""
    return _filled(number)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def scaled_sum(factor: Any, a: Any, b: Any) -> Any:
    """Return factor * a + b, rounded once; the factor is a number or a quad."""
    return _fused(as_quad(factor), a, b)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def transposed(a: Any, b: Any, c: Any, d: Any) -> Any:
    """Four quads, of the first lanes, the second lanes and so on."""
    return _transposed(a, b, c, d)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def halves_swapped(quad: Any) -> Any:
    """The second half of a quad, then its first."""
    return _halves_swapped(quad)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def halves_joined(a: Any, b: Any) -> Any:
    """The first half of a, the second of b."""
    return _halves_joined(a, b)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def first_lanes(quad: Any, count: float, otherwise: float) -> Any:
    """The first lanes of a quad, and another number in the rest."""
    return _first_lanes(quad, count, otherwise)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def total(quad: Any) -> float:
    """The sum of the numbers."""
    return _total(quad)


@register_jitable(forceinline=True)
def smallest(quad: Any) -> float:
    """The smallest of the numbers."""
    return _smallest(quad)


@register_jitable(forceinline=True)
def largest(quad: Any) -> float:
    """The largest of the numbers."""
    return _largest(quad)


def truncated(a: Any) -> Any:
    """Number or quad without what follows the point."""
    return math.trunc(a)


def lesser(a: Any, b: Any) -> Any:
    """The smaller of two numbers or quads, a where b is not a number."""
    return b if b < a else a


def greater(a: Any, b: Any) -> Any:
    """The larger of two numbers or quads, a where b is not a number."""
    return b if b > a else a


def where_equal(a: Any, b: Any, then: Any, otherwise: Any) -> Any:
    """`then` where a = b, for numbers or quads."""
    return then if a == b else otherwise


def some_equal(a: Any, b: Any) -> Any:
    """Whether a = b, in any lane if they are quads."""
    return a == b


@overload(truncated)
def _choose_truncated(a):  # type: ignore[no-untyped-def]
    if isinstance(a, QuadType):
        return lambda a: _truncated(a)  # noqa: PLW0108
    return lambda a: math.floor(a) if a > 0.0 else math.ceil(a)


@overload(math.sqrt)
def _choose_square_root(x):  # type: ignore[no-untyped-def]
    if isinstance(x, QuadType):
        return lambda x: _square_root(x)  # noqa: PLW0108
    return None


@overload(lesser)
def _choose_lesser(a, b):  # type: ignore[no-untyped-def]
    if isinstance(a, QuadType) or isinstance(b, QuadType):
        return lambda a, b: _lesser(as_quad(a), as_quad(b))
    return lambda a, b: b if b < a else a


@overload(greater)
def _choose_greater(a, b):  # type: ignore[no-untyped-def]
    if isinstance(a, QuadType) or isinstance(b, QuadType):
        return lambda a, b: _greater(as_quad(a), as_quad(b))
    return lambda a, b: b if b > a else a


@overload(where_equal)
def _choose_where_equal(a, b, then, otherwise):  # type: ignore[no-untyped-def]
    if isinstance(a, QuadType):
        return lambda a, b, then, otherwise: _where_equal(  # type: ignore[call-arg]
            a, as_quad(b), as_quad(then), as_quad(otherwise)
        )
    return lambda a, b, then, otherwise: then if a == b else otherwise


@overload(some_equal)
def _choose_some_equal(a, b):  # type: ignore[no-untyped-def]
    if isinstance(a, QuadType) or isinstance(b, QuadType):
        return lambda a, b: _some_equal(as_quad(a), as_quad(b))  # type: ignore[call-arg]
    return lambda a, b: a == b
