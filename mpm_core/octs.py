"""Eight singles side by side in a vector register, for compiled code: all components of a node in single precision.

The counterpart of the two `quads` that a node fills in double precision.
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

_VECTOR = ir.VectorType(ir.FloatType(), LANES)
_INDEX = ir.IntType(32)


class OctType(types.Type):
    """The compiler's type of eight singles in a register."""

    def __init__(self) -> None:
        super().__init__(name="Oct")


OCT = OctType()


@register_model(OctType)
class _OctModel(PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _VECTOR)


@intrinsic
def _oct_at(typing_context: Any, array: Any, position: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, alignment = place(context, builder, signature.args[0], arguments, LANES)
        return builder.load(pointer, align=alignment)

    return OCT(array, position), generate


@intrinsic
def _half_oct_at(typing_context: Any, array: Any, position: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, alignment = place(context, builder, signature.args[0], arguments, HALF)
        half = builder.load(pointer, align=alignment)
        zeros = ir.Constant(half.type, [0.0] * HALF)
        return builder.shuffle_vector(half, zeros, ir.Constant(ir.VectorType(_INDEX, LANES), list(range(LANES))))

    return OCT(array, position), generate


@intrinsic
def _put_oct(typing_context: Any, array: Any, position: Any, oct_: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pointer, alignment = place(context, builder, signature.args[0], arguments, LANES)
        builder.store(arguments[2], pointer, align=alignment)
        return context.get_dummy_value()

    return types.void(array, position, OCT), generate


@intrinsic
def _oct_sum(typing_context: Any, a: Any, b: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fadd(arguments[0], arguments[1])

    return OCT(OCT, OCT), generate


@intrinsic
def _scaled_oct_sum(typing_context: Any, factor: Any, a: Any, b: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        undefined = ir.Constant(_VECTOR, ir.Undefined)
        first = builder.insert_element(undefined, arguments[0], ir.Constant(_INDEX, 0))
        factors = builder.shuffle_vector(first, undefined, ir.Constant(ir.VectorType(_INDEX, LANES), [0] * LANES))
        fma = get_or_insert_function(builder.module, ir.FunctionType(_VECTOR, [_VECTOR] * 3), f"llvm.fma.v{LANES}f32")
        return builder.call(fma, [factors, arguments[1], arguments[2]])

    return OCT(types.float32, OCT, OCT), generate


# As in `quads`, closures hold what hands on, not the intrinsics.


@register_jitable(forceinline=True)
def oct_at(array: Any, position: Any) -> Any:
    """The eight singles from a position on."""
    return _oct_at(array, position)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def half_oct_at(array: Any, position: Any) -> Any:
    """The four singles from a position on, and four zeros."""
    return _half_oct_at(array, position)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def put_oct(array: Any, position: Any, oct_: Any) -> None:
    """Store eight singles from a position on."""
    _put_oct(array, position, oct_)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def oct_sum(a: Any, b: Any) -> Any:
    """Return a + b."""
    return _oct_sum(a, b)  # type: ignore[call-arg]


@register_jitable(forceinline=True)
def scaled_oct_sum(number: Any, a: Any, b: Any) -> Any:
    """Return number * a + b, rounded once."""
    return _scaled_oct_sum(number, a, b)  # type: ignore[call-arg]
