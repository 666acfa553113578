"""Numbers side by side in a vector register, for compiled code: types, loading and storing.

The transfers use them in two ways: as one quantity of neighbouring points, which are then worked on together, and as
components of one grid node, which a point changes together. `put_transposed` and `transposed_at` lead from one to the
other. A quad is four numbers; of points, four doubles or eight singles are taken at once.

Arithmetic (`arithmetic`) is written as for scalars. Each lane is rounded like the scalar expression would be, so
that the width of the machine's registers changes the time, not the result.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel.models import PrimitiveModel
from numba.extending import intrinsic, register_jitable, register_model

from grainlaw.materials.precision import PRECISIONS

# Components of half a node.
LANES = 4
# Of points in one pass over them.
BYTES_AT_ONCE = 32
# Points that are taken at once, by their precision, and at most.
LANES_OF = {name: BYTES_AT_ONCE // number().itemsize for name, number in PRECISIONS.items()}
MOST_AT_ONCE = max(LANES_OF.values())

INDEX = ir.IntType(32)
# Of each kind of number: the compiler's type, what it calls it, and its size, which is also the alignment asked for.
SCALARS = {types.float64: (ir.DoubleType(), "f64", 8), types.float32: (ir.FloatType(), "f32", 4)}


class LanesType(types.Type):
    """The compiler's type of some numbers of a kind in a register, or in two where registers are shorter."""

    def __init__(self, number: Any, count: int) -> None:
        self.number = number
        self.count = count
        super().__init__(name=f"Lanes({number}, {count})")


@register_model(LanesType)
class _LanesModel(PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, vector_of(kind))


def vector_of(kind: LanesType) -> Any:
    """What the compiler calls a vector of this kind."""
    return ir.VectorType(SCALARS[kind.number][0], kind.count)


def shuffled(builder: Any, a: Any, b: Any, lanes: list[int]) -> Any:
    """The lanes with these numbers, counted on from those of a to those of b."""
    return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(INDEX, len(lanes)), lanes))


def converted(builder: Any, vector: Any, number: Any) -> Any:
    """A vector with its numbers turned into those of another kind."""
    scalar = SCALARS[number][0]
    if vector.type.element == scalar:
        return vector
    convert = builder.fpext if number is types.float64 else builder.fptrunc
    return convert(vector, ir.VectorType(scalar, vector.type.count))


def _place(context: Any, builder: Any, array_type: Any, array: Any, position: Any, lanes: int) -> tuple[Any, int]:
    """Pointer to so many lanes of an array from a position on, and the alignment of a lane."""
    data = context.make_array(array_type)(context, builder, array).data
    scalar, _, size = SCALARS[array_type.dtype]
    return builder.bitcast(builder.gep(data, [position]), ir.VectorType(scalar, lanes).as_pointer()), size


def _further(builder: Any, position: Any, numbers: int) -> Any:
    return builder.add(position, ir.Constant(position.type, numbers))


def load(context: Any, builder: Any, array_type: Any, array: Any, position: Any, lanes: int) -> Any:
    """So many numbers of an array from a position on, as they are stored."""
    pointer, alignment = _place(context, builder, array_type, array, position, lanes)
    return builder.load(pointer, align=alignment)


def store(context: Any, builder: Any, array_type: Any, array: Any, position: Any, vector: Any) -> None:
    """Store a vector in an array from a position on, as numbers of the array's kind."""
    pointer, alignment = _place(context, builder, array_type, array, position, vector.type.count)
    builder.store(converted(builder, vector, array_type.dtype), pointer, align=alignment)


def _several(number: Any) -> LanesType:
    """As many numbers of a kind as are taken at once."""
    return LanesType(number, BYTES_AT_ONCE // SCALARS[number][2])


def _loading(kind_of: Any) -> Any:
    """An intrinsic (array, position) -> lanes of the kind that belongs to the kind of the array's numbers."""

    @intrinsic
    def loaded(typing_context: Any, array: Any, position: Any) -> Any:
        kind = kind_of(array.dtype)

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            values, place = arguments
            return load(context, builder, signature.args[0], values, place, kind.count)

        return kind(array, position), generate

    return loaded


_quad_at = _loading(lambda number: LanesType(number, LANES))
_several_at = _loading(_several)
_pair_at = _loading(lambda number: LanesType(number, 2))
_oct_at = _loading(lambda number: LanesType(number, 2 * LANES))


@intrinsic
def _half_oct_at(typing_context: Any, array: Any, position: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        values, place = arguments
        half = load(context, builder, signature.args[0], values, place, LANES)
        nothing = ir.Constant(half.type, [-0.0] * LANES)
        return shuffled(builder, half, nothing, list(range(2 * LANES)))

    return LanesType(array.dtype, 2 * LANES)(array, position), generate


@intrinsic
def _twice_at(typing_context: Any, array: Any, position: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        values, place = arguments
        half = load(context, builder, signature.args[0], values, place, LANES)
        return shuffled(builder, half, half, [*range(LANES), *range(LANES)])

    return LanesType(array.dtype, 2 * LANES)(array, position), generate


@intrinsic
def _two_numbers(typing_context: Any, first: Any, second: Any) -> Any:
    kind = LanesType(first, 2 * LANES)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        vector = ir.Constant(vector_of(kind), ir.Undefined)
        for lane, number in enumerate(arguments):
            vector = builder.insert_element(vector, number, ir.Constant(INDEX, lane))
        return shuffled(builder, vector, vector, [0] * LANES + [1] * LANES)

    return kind(first, first), generate


def _half(number: int) -> Any:
    """One half of some lanes."""

    @intrinsic
    def half(typing_context: Any, lanes: Any) -> Any:
        count = lanes.count // 2

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            (whole,) = arguments
            return shuffled(builder, whole, whole, list(range(number * count, (number + 1) * count)))

        return LanesType(lanes.number, count)(lanes), generate

    return half


_first_half, _second_half = _half(0), _half(1)


@intrinsic
def _put(typing_context: Any, array: Any, position: Any, lanes: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        store(context, builder, signature.args[0], *arguments)
        return context.get_dummy_value()

    return types.void(array, position, lanes), generate


def _transposed(builder: Any, a: Any, b: Any, c: Any, d: Any) -> list[Any]:
    """Four vectors, of four or eight lanes: in each four lanes those that were the first, second, third or fourth.

    With eight lanes, each four are turned by themselves.
    """
    count = a.type.count
    fours = range(0, count, 4)
    low = [lane for four in fours for lane in (four, four + count, four + 1, four + 1 + count)]
    high = [lane + 2 for lane in low]
    first = [lane for four in fours for lane in (four, four + 1, four + count, four + 1 + count)]
    second = [lane + 2 for lane in first]
    low_ab, high_ab = shuffled(builder, a, b, low), shuffled(builder, a, b, high)
    low_cd, high_cd = shuffled(builder, c, d, low), shuffled(builder, c, d, high)
    pairs = (low_ab, low_cd, first), (low_ab, low_cd, second), (high_ab, high_cd, first), (high_ab, high_cd, second)
    return [shuffled(builder, *pair) for pair in pairs]


def _by_points(builder: Any, count: int, first: list[Any], second: list[Any]) -> Iterator[tuple[int, Any]]:
    """Vectors of whole points, or of their halves, and how far from the first they belong."""
    if count == LANES:
        # Two stores of four doubles are faster than one of eight.
        for half, rows in enumerate((first, second)):
            yield from ((LANES * (2 * point + half), row) for point, row in enumerate(rows))
        return
    for point in range(count):
        four, row = divmod(point, LANES)
        lanes = [LANES * four + lane for lane in range(LANES)]
        yield 2 * LANES * point, shuffled(builder, first[row], second[row], [*lanes, *(count + k for k in lanes)])


@intrinsic
def _put_transposed(typing_context: Any, vectors: Any, position: Any, components: Any) -> Any:
    kind = components.dtype

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array, position, packed = arguments
        given = cgutils.unpack_tuple(builder, packed, 2 * LANES)
        halves = [_transposed(builder, *given[:LANES]), _transposed(builder, *given[LANES:])]
        for distance, vector in _by_points(builder, kind.count, *halves):
            store(context, builder, signature.args[0], array, _further(builder, position, distance), vector)
        return context.get_dummy_value()

    return types.void(vectors, position, components), generate


@intrinsic
def _transposed_at(typing_context: Any, vectors: Any, position: Any, stride: Any) -> Any:
    kind = _several(vectors.dtype)
    result = types.UniTuple(kind, LANES)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array, position, stride = arguments
        places = [builder.add(position, builder.mul(stride, ir.Constant(stride.type, k))) for k in range(kind.count)]
        points = [load(context, builder, signature.args[0], array, place, LANES) for place in places]
        if kind.count > LANES:
            both = list(range(2 * LANES))
            points = [shuffled(builder, points[row], points[row + LANES], both) for row in range(LANES)]
        return context.make_tuple(builder, result, _transposed(builder, *points))

    return result(vectors, position, stride), generate


# What follows hands on, so that closures over it have the same mark in every process: that of an intrinsic is random,
# and a kernel with one in its closure would be compiled again by each.


@register_jitable(forceinline=True)
def quad_at(array: Any, position: Any) -> Any:
    """The four numbers from a position on, as they are stored."""
    return _quad_at(array, position)


@register_jitable(forceinline=True)
def several_at(array: Any, position: Any) -> Any:
    """The four doubles or eight singles from a position on."""
    return _several_at(array, position)


@register_jitable(forceinline=True)
def pair_at(array: Any, position: Any) -> Any:
    """The two numbers from a position on, as they are stored."""
    return _pair_at(array, position)


@register_jitable(forceinline=True)
def oct_at(array: Any, position: Any) -> Any:
    """The eight numbers from a position on, as they are stored: all components of a node."""
    return _oct_at(array, position)


@register_jitable(forceinline=True)
def half_oct_at(array: Any, position: Any) -> Any:
    """The four numbers from a position on, and four times -0, which added to anything leaves it as it is."""
    return _half_oct_at(array, position)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def twice_at(array: Any, position: Any) -> Any:
    """The four numbers from a position on, and the same again, as they are stored."""
    return _twice_at(array, position)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def two_numbers(first: Any, second: Any) -> Any:
    """Four times one number and four times another."""
    return _two_numbers(first, second)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def first_half(lanes: Any) -> Any:
    """The first half of some lanes."""
    return _first_half(lanes)


@register_jitable(forceinline=True)
def second_half(lanes: Any) -> Any:
    """The second half of some lanes."""
    return _second_half(lanes)


@register_jitable(forceinline=True)
def put(array: Any, position: Any, lanes: Any) -> None:
    """Store numbers from a position on."""
    _put(array, position, lanes)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def put_transposed(vectors: Any, k: Any, components: Any) -> None:
    """Store a tuple of eight components of the points from k on, each point's side by side."""
    _put_transposed(vectors, 2 * LANES * k, components)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def transposed_at(vectors: Any, k: Any) -> Any:
    """Four components of four or eight points from k on, each component of them side by side."""
    return _transposed_at(vectors, LANES * k, np.uint64(LANES))  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def half_transposed_at(vectors: Any, k: Any, half: Any) -> Any:
    """The first (0) or the last (1) four of eight components of the points from k on, each of them side by side."""
    return _transposed_at(vectors, 2 * LANES * k + LANES * half, np.uint64(2 * LANES))  # type: ignore[call-arg]
