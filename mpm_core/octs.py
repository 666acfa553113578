"""Eight numbers side by side in a vector register, for compiled code: all components of a node.

Doubles or singles, as the array holds them. Where registers are shorter than that, the compiler takes two.
"""

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.cgutils import get_or_insert_function
from numba.core.datamodel.models import PrimitiveModel
from numba.extending import intrinsic, register_jitable, register_model

from mpm_core.quads import place

LANES = 8
HALF = LANES // 2

_INDEX = ir.IntType(32)
# Of each kind of number: what the compiler calls it.
_SCALARS = {types.float64: (ir.DoubleType(), "f64"), types.float32: (ir.FloatType(), "f32")}


class OctType(types.Type):
    """The compiler's type of eight numbers of a kind in a register."""

    def __init__(self, number: Any) -> None:
        self.number = number
        super().__init__(name=f"Oct({number})")


@register_model(OctType)
class _OctModel(PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.VectorType(_SCALARS[kind.number][0], LANES))


def _lanes(numbers: list[int]) -> Any:
    return ir.Constant(ir.VectorType(_INDEX, LANES), numbers)


@intrinsic
def _oct_at(typing_context: Any, array: Any, position: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, alignment = place(context, builder, signature.args[0], arguments, LANES)
        return builder.load(pointer, align=alignment)

    return OctType(array.dtype)(array, position), generate


@intrinsic
def _half_oct_at(typing_context: Any, array: Any, position: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, alignment = place(context, builder, signature.args[0], arguments, HALF)
        half = builder.load(pointer, align=alignment)
        nothing = ir.Constant(half.type, [-0.0] * HALF)
        return builder.shuffle_vector(half, nothing, _lanes(list(range(LANES))))

    return OctType(array.dtype)(array, position), generate


@intrinsic
def _put_oct(typing_context: Any, array: Any, position: Any, oct_: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, alignment = place(context, builder, signature.args[0], arguments, LANES)
        builder.store(arguments[2], pointer, align=alignment)
        return context.get_dummy_value()

    return types.void(array, position, oct_), generate


@intrinsic
def _oct_sum(typing_context: Any, a: Any, b: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fadd(arguments[0], arguments[1])

    return a(a, a), generate


@intrinsic
def _scaled_oct_sum(typing_context: Any, factor: Any, a: Any, b: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        vector, name = arguments[1].type, _SCALARS[a.number][1]
        undefined = ir.Constant(vector, ir.Undefined)
        first = builder.insert_element(undefined, arguments[0], ir.Constant(_INDEX, 0))
        factors = builder.shuffle_vector(first, undefined, _lanes([0] * LANES))
        fma = get_or_insert_function(builder.module, ir.FunctionType(vector, [vector] * 3), f"llvm.fma.v{LANES}{name}")
        return builder.call(fma, [factors, arguments[1], arguments[2]])

    return a(a.number, a, a), generate


# As in `quads`, closures hold what hands on, not the intrinsics.


@register_jitable(forceinline=True)
def oct_at(array: Any, position: Any) -> Any:
    """The eight numbers from a position on."""
    return _oct_at(array, position)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def half_oct_at(array: Any, position: Any) -> Any:
    """The four numbers from a position on, and four times -0, which added to anything leaves it as it is."""
    return _half_oct_at(array, position)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def put_oct(array: Any, position: Any, oct_: Any) -> None:
    """Store eight numbers from a position on."""
    _put_oct(array, position, oct_)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def oct_sum(a: Any, b: Any) -> Any:
    """Return a + b."""
    return _oct_sum(a, b)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def scaled_oct_sum(number: Any, a: Any, b: Any) -> Any:
    """Return number * a + b, rounded once."""
    return _scaled_oct_sum(number, a, b)  # type: ignore[call-arg]
