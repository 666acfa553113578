"""The stencils of points, found four at a time, and what the transfers keep of a group in the nearest cache."""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from numba.extending import register_jitable

from materials.compilation import named
from mpm_core.basis import Basis, make_stencil
from mpm_core.columns import X, Y
from mpm_core.quads import LANES, put_quad, quad_at, transposed
from mpm_core.sources import CORE_MARK

# Points that a transfer takes through its parts together.
GROUP = 64


class Axis(NamedTuple):
    """Where points lie in their stencils along an axis.

    place       distance from the first node, in cells
    weights     w of each node
    moment      second moment of the weights, in cells squared
    per_moment  its inverse
    """

    place: Any
    weights: Any
    moment: Any
    per_moment: Any


@cache
def make_find_stencils(basis: Basis) -> Callable[..., Any]:
    """A function that gives, of four points at a time, the number of the first node and both axes of the stencil."""
    stencil = make_stencil(basis)

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def find_stencils(rows, p, nodes_y, ghosts, origin, inverse_size):  # type: ignore[no-untyped-def]
        x, y = quad_at(rows[X], p), quad_at(rows[Y], p)
        i, fx, wx, moment_x, per_moment_x = stencil((x - origin[0]) * inverse_size, ghosts[0], ghosts[1])
        j, fy, wy, moment_y, per_moment_y = stencil((y - origin[1]) * inverse_size, ghosts[2], ghosts[3])
        return i * nodes_y + j, Axis(fx, wx, moment_x, per_moment_x), Axis(fy, wy, moment_y, per_moment_y)

    return find_stencils


@register_jitable(forceinline=True)
def put_transposed(vectors, position, stride, a, b, c, d):  # type: ignore[no-untyped-def]
    """Store four components of four points: each point's side by side, from a position on, points a stride apart."""
    first, second, third, fourth = transposed(a, b, c, d)
    put_quad(vectors, position, first)
    put_quad(vectors, position + stride, second)
    put_quad(vectors, position + 2 * stride, third)
    put_quad(vectors, position + 3 * stride, fourth)


@register_jitable(forceinline=True)
def four_transposed(vectors, k):  # type: ignore[no-untyped-def]
    """Four components of the points from k on, each component of four points side by side."""
    return transposed(
        quad_at(vectors, LANES * k),
        quad_at(vectors, LANES * k + LANES),
        quad_at(vectors, LANES * k + 2 * LANES),
        quad_at(vectors, LANES * k + 3 * LANES),
    )
