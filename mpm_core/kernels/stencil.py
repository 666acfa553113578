"""The stencils of points, found for several at a time, and the groups that the transfers keep in the nearest cache."""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.shape_functions import Basis, make_stencil
from grainlaw.mpm_core.kernels.sources import CORE_MARK

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
def make_find_stencils(basis: Basis, precision: str) -> Callable[..., Any]:
    """A function that gives, of several points at a time, the number of the first node and both axes of the stencil.

    The precision is that of the points.
    """
    stencil, position_at = make_stencil(basis, precision), position_access(precision).at

    @register_jitable(forceinline=True)
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def find_stencils(rows, p, nodes_y, ghosts, origin, inverse_size):  # type: ignore[no-untyped-def]
        x, y = position_at(rows, p)
        i, fx, wx, moment_x, per_moment_x = stencil((x - origin[0]) * inverse_size, ghosts[0], ghosts[1])
        j, fy, wy, moment_y, per_moment_y = stencil((y - origin[1]) * inverse_size, ghosts[2], ghosts[3])
        return i * nodes_y + j, Axis(fx, wx, moment_x, per_moment_x), Axis(fy, wy, moment_y, per_moment_y)

    return find_stencils
