"""The stencils of a group of points: found together, four at a time, and kept in the nearest cache."""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable

from materials.compilation import named
from mpm_core.basis import Basis, make_stencil
from mpm_core.quads import LANES, put_quad, quad_at, transposed
from mpm_core.sources import CORE_MARK

# Points that a transfer takes through its parts together.
GROUP = 64


class Stencils(NamedTuple):
    """What the transfers need of each point of a group; per axis, those of one node for the whole group side by side.

    starts                number of the first node
    weights_x, weights_y  w

    of points that receive:

    slopes_x, slopes_y    w (i - f)/(h moment) [1/m], of which the moving-least-squares gradient is made
    moment_x, moment_y    second moments of the weights, in cells squared

    and of points that bring:

    x, y                  distance f from the first node, in cells
    per_moment_x, ...     inverses of the second moments
    """

    starts: Any
    weights_x: Any
    weights_y: Any
    slopes_x: Any
    slopes_y: Any
    moment_x: Any
    moment_y: Any
    x: Any
    y: Any
    per_moment_x: Any
    per_moment_y: Any


@cache
def make_find_stencils(basis: Basis, receive: bool) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Functions that make room for the stencils of a group, and fill it for the points from `first` to `last`.

    `receive` is whether the points receive from the grid or bring to it; what the other needs is left empty.
    """
    width, stencil = basis.width, make_stencil(basis)
    mark = f"{basis.name}_{receive:d}_{CORE_MARK}"

    @register_jitable(forceinline=True)
    @named(mark)
    def room_for_stencils():  # type: ignore[no-untyped-def]
        per_node, per_point = np.empty((4, width * GROUP)), np.empty((7, GROUP))
        return Stencils(
            per_point[0],
            per_node[0],
            per_node[1],
            per_node[2],
            per_node[3],
            per_point[1],
            per_point[2],
            per_point[3],
            per_point[4],
            per_point[5],
            per_point[6],
        )

    @register_jitable(forceinline=True)
    @named(mark)
    def put_slopes(slopes, k, weights, f, scale):  # type: ignore[no-untyped-def]
        for a in range(width):
            put_quad(slopes, a * GROUP + k, weights[a] * (float(a) - f) * scale)

    @register_jitable(forceinline=True)
    @named(mark)
    def find_stencils(x, y, first, last, nodes_y, ghosts, origin, cell_size, stencils):  # type: ignore[no-untyped-def]
        inverse_size = 1.0 / cell_size
        for p in range(first, last, LANES):
            k = p - first
            i, fx, wx, moment_x, per_moment_x = stencil(
                (quad_at(x, p) - origin[0]) * inverse_size, ghosts[0], ghosts[1]
            )
            j, fy, wy, moment_y, per_moment_y = stencil(
                (quad_at(y, p) - origin[1]) * inverse_size, ghosts[2], ghosts[3]
            )
            put_quad(stencils.starts, k, i * nodes_y + j)
            for a in range(width):
                put_quad(stencils.weights_x, a * GROUP + k, wx[a])
                put_quad(stencils.weights_y, a * GROUP + k, wy[a])
            if receive:
                put_slopes(stencils.slopes_x, k, wx, fx, inverse_size * per_moment_x)
                put_slopes(stencils.slopes_y, k, wy, fy, inverse_size * per_moment_y)
                put_quad(stencils.moment_x, k, moment_x)
                put_quad(stencils.moment_y, k, moment_y)
            else:
                put_quad(stencils.x, k, fx)
                put_quad(stencils.y, k, fy)
                put_quad(stencils.per_moment_x, k, per_moment_x)
                put_quad(stencils.per_moment_y, k, per_moment_y)

    return room_for_stencils, find_stencils


@register_jitable(forceinline=True)
def put_transposed(vectors, k, a, b, c, d):  # type: ignore[no-untyped-def]
    """Store four components of four points, each point's side by side, from point k of a group on."""
    first, second, third, fourth = transposed(a, b, c, d)
    put_quad(vectors, LANES * k, first)
    put_quad(vectors, LANES * k + LANES, second)
    put_quad(vectors, LANES * k + 2 * LANES, third)
    put_quad(vectors, LANES * k + 3 * LANES, fourth)


@register_jitable(forceinline=True)
def four_transposed(vectors, k):  # type: ignore[no-untyped-def]
    """Four components of the points from k on, each component of four points side by side."""
    return transposed(
        quad_at(vectors, LANES * k),
        quad_at(vectors, LANES * k + LANES),
        quad_at(vectors, LANES * k + 2 * LANES),
        quad_at(vectors, LANES * k + 3 * LANES),
    )
