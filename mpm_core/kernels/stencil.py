"""The stencils of points, found for several at a time, and the groups that the transfers keep in the nearest cache."""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.shape_functions import Basis, make_stencil
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.space import Space

# Points that a transfer takes through its parts together.
GROUP = 64
# In three dimensions, where a point has more of everything.
GROUP_3D = 32


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
def make_find_stencils(space: Space, basis: Basis, precision: str) -> Callable[..., Any]:
    """A function that gives, of several points at a time, the number of the first node and their axes in the stencil.

    `strides` are those of the grid, in nodes. The precision is that of the points.
    """
    stencil, position_at = make_stencil(basis, precision), position_access(space, precision).at

    @register_jitable(forceinline=True)
    @named(f"{space.name}_{basis.name}_{precision}_{CORE_MARK}")
    def find_axis(coordinate, axis, ghosts, origin, inverse_size):  # type: ignore[no-untyped-def]
        i, f, w, moment, per_moment = stencil(
            (coordinate - origin[axis]) * inverse_size, ghosts[2 * axis], ghosts[2 * axis + 1]
        )
        return i, Axis(f, w, moment, per_moment)

    @register_jitable(forceinline=True)
    @named(f"{space.name}_{basis.name}_{precision}_{CORE_MARK}")
    def find_stencils_2d(rows, p, strides, ghosts, origin, inverse_size):  # type: ignore[no-untyped-def]
        x, y = position_at(rows, p)
        i, along_x = find_axis(x, 0, ghosts, origin, inverse_size)
        j, along_y = find_axis(y, 1, ghosts, origin, inverse_size)
        return i * strides[0] + j, along_x, along_y

    @register_jitable(forceinline=True)
    @named(f"{space.name}_{basis.name}_{precision}_{CORE_MARK}")
    def find_stencils_3d(rows, p, strides, ghosts, origin, inverse_size):  # type: ignore[no-untyped-def]
        x, y, z = position_at(rows, p)
        i, along_x = find_axis(x, 0, ghosts, origin, inverse_size)
        j, along_y = find_axis(y, 1, ghosts, origin, inverse_size)
        k, along_z = find_axis(z, 2, ghosts, origin, inverse_size)
        return i * strides[0] + j * strides[1] + k, along_x, along_y, along_z

    return {2: find_stencils_2d, 3: find_stencils_3d}[space.axes]
