"""A loop over points of which the compiler takes several at a time, more than it would think worth while.

What a law does at a point mostly waits for its own last operation, a root or a division, while points do not wait for
one another. That several fit into a register the compiler sees; that it pays to have several registers under way it
does not see, as the loop is long. Metadata of this loop tells it so.
"""

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic, register_jitable

# Points in a register, or in two where registers are shorter, and how many of these are under way.
OPTIONS = (("llvm.loop.vectorize.width", 8), ("llvm.loop.interleave.count", 2))


@intrinsic
def _loop_over_points(typing_context: Any, first: Any, last: Any, work: Any, arguments: Any) -> Any:
    call = work.get_call_type(typing_context, (first, *arguments.types), {})

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        begin, end, _, packed = values
        function = context.get_function(work, call)
        context.add_linking_libs(getattr(function, "libs", ()))
        before, loop, after = builder.block, *map(builder.append_basic_block, ("points", "behind_points"))
        builder.cbranch(builder.icmp_unsigned("<", begin, end), loop, after)
        builder.position_at_end(loop)
        point = builder.phi(begin.type)
        function(builder, (point, *cgutils.unpack_tuple(builder, packed)))
        following = builder.add(point, ir.Constant(begin.type, 1), flags=["nuw"])
        point.add_incoming(begin, before)
        point.add_incoming(following, builder.block)
        again = builder.cbranch(builder.icmp_unsigned("<", following, end), loop, after)
        again.set_metadata("llvm.loop", _loop_metadata(builder.module))
        builder.position_at_end(after)
        return context.get_dummy_value()

    return types.void(first, first, work, arguments), generate


def _loop_metadata(module: Any) -> Any:
    """A node with the options of a loop; it has to begin with itself."""
    options = [
        module.add_metadata([ir.MetaDataString(module, name), ir.Constant(ir.IntType(32), value)])
        for name, value in OPTIONS
    ]
    node = ir.values.MDValue(module, [], name=str(len(module.metadata)))
    node.operands = (node, *options)
    return node


# As in `lanes`, closures hold what hands on, not the intrinsic.


@register_jitable(forceinline=True)
def loop_over_points(first: Any, last: Any, work: Any, arguments: Any) -> None:
    """Call work(p, *arguments) for each point from the first to the one before the last; none depends on another."""
    _loop_over_points(first, last, work, arguments)  # type: ignore[call-arg]
