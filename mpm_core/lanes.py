"""The components of a grid node as one vector register, for compiled code.

A node holds LANES doubles, one cache line. What a transfer does to one component it does to all, so that a node costs a
load, one or two fused multiply-adds and a store. Each lane is rounded like the scalar expression would be: the width of
the machine's registers changes the time, not the result.
"""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.cgutils import get_or_insert_function
from numba.core.datamodel.models import PrimitiveModel
from numba.extending import intrinsic, register_jitable, register_model

LANES = 8
BYTES = 8 * LANES

_VECTOR = ir.VectorType(ir.DoubleType(), LANES)
_INDEX = ir.IntType(32)


class LanesType(types.Type):
    """The compiler's type of LANES doubles in a register."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


LANES_TYPE = LanesType()


@register_model(LanesType)
class _LanesModel(PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _VECTOR)


@intrinsic
def _lanes(typing_context: Any, values: Any) -> Any:

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        vector = ir.Constant(_VECTOR, ir.Undefined)
        for lane in range(LANES):
            value = builder.extract_value(arguments[0], lane)
            vector = builder.insert_element(vector, value, ir.Constant(_INDEX, lane))
        return vector

    return LANES_TYPE(types.UniTuple(types.float64, LANES)), generate


@intrinsic
def _lane(typing_context: Any, vector: Any, index: Any) -> Any:

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.extract_element(arguments[0], ir.Constant(_INDEX, index.literal_value))

    if not isinstance(index, types.IntegerLiteral):
        return None
    return types.float64(LANES_TYPE, index), generate


@intrinsic
def _fused(typing_context: Any, factor: Any, a: Any, b: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        undefined = ir.Constant(_VECTOR, ir.Undefined)
        first = builder.insert_element(undefined, arguments[0], ir.Constant(_INDEX, 0))
        everywhere = ir.Constant(ir.VectorType(_INDEX, LANES), [0] * LANES)
        factors = builder.shuffle_vector(first, undefined, everywhere)
        fma = get_or_insert_function(builder.module, ir.FunctionType(_VECTOR, [_VECTOR] * 3), f"llvm.fma.v{LANES}f64")
        return builder.call(fma, [factors, arguments[1], arguments[2]])

    return LANES_TYPE(types.float64, LANES_TYPE, LANES_TYPE), generate


@intrinsic
def _load(typing_context: Any, array: Any, position: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load(_place(context, builder, signature, arguments), align=BYTES)

    return LANES_TYPE(array, position), generate


@intrinsic
def _store(typing_context: Any, array: Any, position: Any, vector: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.store(arguments[2], _place(context, builder, signature, arguments), align=BYTES)
        return context.get_dummy_value()

    return types.void(array, position, LANES_TYPE), generate


def _place(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    return builder.bitcast(builder.gep(array.data, [arguments[1]]), _VECTOR.as_pointer())


# (tuple of LANES scalars) -> the scalars side by side
lanes: Callable[..., Any] = _lanes
# (vector, constant index) -> one of the scalars
lane: Callable[..., float] = _lane


@register_jitable
def scaled_sum(factor, a, b):  # type: ignore[no-untyped-def]
    """Factor * a + b in every lane, rounded once."""
    return _fused(factor, a, b)  # type: ignore[call-arg]


@register_jitable
def node_at(nodes, position):  # type: ignore[no-untyped-def]
    """The node whose first component stands at a position of the flat, aligned array of nodes."""
    return _load(nodes, position)  # type: ignore[call-arg]


@register_jitable
def deposit(nodes, position, weight, amounts):  # type: ignore[no-untyped-def]
    """Add weight * amounts to a node."""
    _store(nodes, position, _fused(weight, amounts, _load(nodes, position)))  # type: ignore[call-arg]
