"""The rows of the point array, for compiled code.

Loops over points take each row as an array of its own. Handing a pass twenty arrays costs more than its start does: it
takes the whole and parts it itself.
"""

from typing import Any

from numba.core import cgutils, types
from numba.extending import intrinsic, register_jitable
from numba.np.arrayobj import populate_array


@intrinsic
def _rows_of(typing_context: Any, storage: Any, as_many: Any) -> Any:
    row = types.Array(storage.dtype, 1, "C")
    rows = types.UniTuple(row, len(as_many))

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        distance, stride = cgutils.unpack_tuple(builder, array.strides, 2)
        _, length = cgutils.unpack_tuple(builder, array.shape, 2)
        found = []
        for number in range(len(rows)):
            start = builder.mul(distance, context.get_constant(types.intp, number))
            part = context.make_array(row)(context, builder)
            populate_array(
                part,
                data=cgutils.pointer_add(builder, array.data, start, array.data.type),
                shape=[length],
                strides=[stride],
                itemsize=array.itemsize,
                meminfo=array.meminfo,
                parent=None,
            )
            context.nrt.incref(builder, row, part._getvalue())
            found.append(part._getvalue())
        return context.make_tuple(builder, rows, found)

    return rows(storage, as_many), generate


@register_jitable
def rows_of(storage, as_many):  # type: ignore[no-untyped-def]
    """The first rows of a contiguous two-dimensional array, as many as a tuple is long."""
    return _rows_of(storage, as_many)  # type: ignore[call-arg]
