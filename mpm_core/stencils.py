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
    """What the transfers need of each point of a group; lengths in cells.

    starts              number of the first node
    weights             of all nodes, those of one node for the whole group side by side
    x, y                distance from the first node
    moment_x, moment_y  second moments of the weights
    """

    starts: Any
    weights: Any
    x: Any
    y: Any
    moment_x: Any
    moment_y: Any


@cache
def make_find_stencils(basis: Basis) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Functions that make room for the stencils of a group, and fill it for the points from `first` to `last`."""
    width, stencil = basis.width, make_stencil(basis)
    nodes = width * width

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def room_for_stencils():  # type: ignore[no-untyped-def]
        room = np.empty((5 + nodes) * GROUP)
        starts, x, y = room[:GROUP], room[GROUP : 2 * GROUP], room[2 * GROUP : 3 * GROUP]
        moment_x, moment_y = room[3 * GROUP : 4 * GROUP], room[4 * GROUP : 5 * GROUP]
        return Stencils(starts, room[5 * GROUP :], x, y, moment_x, moment_y)

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def find_stencils(x, y, first, last, nodes_y, ghosts, origin, cell_size, stencils):  # type: ignore[no-untyped-def]
        inverse_size = 1.0 / cell_size
        starts, weights, places_x, places_y, moments_x, moments_y = stencils
        for p in range(first, last, LANES):
            k = p - first
            i, fx, wx, moment_x = stencil((quad_at(x, p) - origin[0]) * inverse_size, ghosts[0], ghosts[1])
            j, fy, wy, moment_y = stencil((quad_at(y, p) - origin[1]) * inverse_size, ghosts[2], ghosts[3])
            put_quad(starts, k, i * nodes_y + j)
            for a in range(width):
                for b in range(width):
                    put_quad(weights, (a * width + b) * GROUP + k, wx[a] * wy[b])
            put_quad(places_x, k, fx)
            put_quad(places_y, k, fy)
            put_quad(moments_x, k, moment_x)
            put_quad(moments_y, k, moment_y)

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
