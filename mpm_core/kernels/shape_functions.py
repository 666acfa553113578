"""B-spline shape functions on a regular grid, in units of the cell size.

Each basis gives, for a point at the distance f from the first node of its stencil, the weights of the `width` nodes
along one axis, and the second moment sum(w (i - f)^2), by which the affine transfer and the moving-least-squares
gradient are scaled (Jiang et al. 2015; Hu et al. 2018). The functions take a point, or several side by side (`lanes`).

A wall lies on a line of nodes, and stencils of points near it reach a ghost node beyond. The ghost's velocity is tied
to the two nodes inside by linear extrapolation, v_ghost = 2 v_wall - v_inside, which changes the weights: twice the
ghost's weight goes to the wall node and minus its weight to the node inside. The weights that remain interpolate at the
wall and reproduce linear fields, so that no order is lost to it; the second moment loses twice the ghost's weight.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.kernels.simd.arithmetic import greater, lesser, rounding_to, some_equal, truncated, where_equal
from grainlaw.mpm_core.kernels.sources import CORE_MARK

# Towards a wall the moment goes to zero with the mass of the row inside, and stiffness over mass grows without bound.
# Below this value, at a twentieth of a cell from the wall, a point is taken to be that far: no explicit step that is
# stable elsewhere then fails there. Points are generated farther away than that.
SMALLEST_MOMENT_AT_WALL = 0.05
# Towards the axis of axisymmetry the stretch around it has the same growth, as it is over the radius. Below this
# distance, in cells, a point is taken to be that far: alone there, it holds at the default step. Points are generated
# farther away.
SMALLEST_RADIUS = 0.08
# The moment of hat functions vanishes at every node; the far node has no weight there either.
SMALLEST_MOMENT_OF_HATS = 1e-12


@dataclass(frozen=True)
class Basis:
    """Shape functions along one axis.

    width         number of nodes of a stencil
    offset        the first node of the stencil of a point at x is floor(x - offset)
    weights       weights of the nodes at the distance f from the first
    moment        second moment of the weights about the point
    lower_wall    weights where the first node is a ghost
    upper_wall    weights where the last node is a ghost
    """

    name: str
    width: int
    offset: float
    weights: Callable[..., tuple[float, ...]]
    moment: Callable[[float], float]
    lower_wall: Callable[..., tuple[float, ...]]
    upper_wall: Callable[..., tuple[float, ...]]


@register_jitable
def first_node(coordinate, origin, cell_size, offset):  # type: ignore[no-untyped-def]
    """Number of the first node of the stencil of a point along an axis; it lies beyond the origin by the offset."""
    return int((coordinate - origin) / cell_size - offset)


@register_jitable
def linear_weights(f: float) -> tuple[float, float]:
    """Hat functions."""
    return 1.0 - f, f


@register_jitable
def linear_moment(f: float) -> float:
    """F (1 - f), which vanishes at the nodes together with the weight of the far node."""
    return f * (1.0 - f)


@register_jitable
def linear_at_wall(w: tuple[float, float]) -> tuple[float, float]:
    """Hat functions do not reach beyond a wall."""
    return w


@register_jitable
def quadratic_weights(f: float) -> tuple[float, float, float]:
    """Quadratic B-spline, f in [1/2, 3/2)."""
    return 0.5 * (1.5 - f) * (1.5 - f), 0.75 - (f - 1.0) * (f - 1.0), 0.5 * (f - 0.5) * (f - 0.5)


@register_jitable
def quadratic_moment(f: float) -> float:
    """1/4 everywhere."""
    return 0.25 + 0.0 * f


@register_jitable
def quadratic_at_lower_wall(w: tuple[float, float, float]) -> tuple[float, float, float]:
    """First node tied to the next two."""
    return 0.0, w[1] + 2.0 * w[0], w[2] - w[0]


@register_jitable
def quadratic_at_upper_wall(w: tuple[float, float, float]) -> tuple[float, float, float]:
    """Last node tied to the two before."""
    return w[0] - w[2], w[1] + 2.0 * w[2], 0.0


@register_jitable
def cubic_weights(f: float) -> tuple[float, float, float, float]:
    """Cubic B-spline, f in [1, 2)."""
    a, b = 2.0 - f, f - 1.0
    return (
        a * a * a / 6.0,
        2.0 / 3.0 - b * b * (1.0 - 0.5 * b),
        2.0 / 3.0 - a * a * (1.0 - 0.5 * a),
        b * b * b / 6.0,
    )


@register_jitable
def cubic_moment(f: float) -> float:
    """1/3 everywhere."""
    return 1.0 / 3.0 + 0.0 * f


@register_jitable
def cubic_at_lower_wall(w: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    """First node tied to the next two."""
    return 0.0, w[1] + 2.0 * w[0], w[2] - w[0], w[3]


@register_jitable
def cubic_at_upper_wall(w: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    """Last node tied to the two before."""
    return w[0], w[1] - w[3], w[2] + 2.0 * w[3], 0.0


BASES = {
    basis.name: basis
    for basis in (
        Basis("linear", 2, 0.0, linear_weights, linear_moment, linear_at_wall, linear_at_wall),
        Basis(
            "quadratic", 3, 0.5, quadratic_weights, quadratic_moment, quadratic_at_lower_wall, quadratic_at_upper_wall
        ),
        Basis("cubic", 4, 1.0, cubic_weights, cubic_moment, cubic_at_lower_wall, cubic_at_upper_wall),
    )
}


def make_stencil(basis: Basis, precision: str = "double") -> Callable[..., Any]:
    """A function (grid coordinate, lower ghost, upper ghost) -> (first node, f, weights, moment, 1/moment).

    The first node is a whole number, but a double, like the coordinate, or lanes of them; the rest has the precision.
    """
    width, offset, weights = basis.width, basis.offset, basis.weights
    moment_of, at_lower_wall, at_upper_wall = basis.moment, basis.lower_wall, basis.upper_wall
    smallest = SMALLEST_MOMENT_AT_WALL if width > 2 else SMALLEST_MOMENT_OF_HATS
    select, rounded = _make_select(width), rounding_to(precision)
    # Away from walls the moment of wide splines is the same everywhere, and no point needs a division.
    inverse_inside = 1.0 / basis.moment(1.0) if width > 2 else 0.0

    @register_jitable
    @named(f"{basis.name}_{precision}_{CORE_MARK}")
    def stencil(coordinate, lower_ghost, upper_ghost):  # type: ignore[no-untyped-def]
        # A point exactly on the upper wall belongs to the last cell.
        last_first = float(upper_ghost - width + 1)
        first = lesser(truncated(coordinate - offset), last_first)
        f = rounded(coordinate - first)
        w, moment, lower = weights(f), greater(moment_of(f), smallest), float(lower_ghost)
        inverse = inverse_inside + 0.0 * f if width > 2 else 1.0 / moment
        if some_equal(first, lower) or some_equal(first, last_first):
            tied = where_equal(first, lower, w[0], where_equal(first, last_first, w[width - 1], 0.0))
            at_wall = select(first, last_first, at_upper_wall(w), w)
            w, moment = select(first, lower, at_lower_wall(w), at_wall), greater(moment_of(f) - 2.0 * tied, smallest)
            inverse = 1.0 / moment
        return first, f, w, moment, inverse

    return stencil


def _make_select(width: int) -> Callable[..., Any]:
    """`where_equal` for tuples of `width` items."""

    @register_jitable
    def select_2(a, b, then, otherwise):  # type: ignore[no-untyped-def]
        return where_equal(a, b, then[0], otherwise[0]), where_equal(a, b, then[1], otherwise[1])

    @register_jitable
    def select_3(a, b, then, otherwise):  # type: ignore[no-untyped-def]
        return (*select_2(a, b, then, otherwise), where_equal(a, b, then[2], otherwise[2]))

    @register_jitable
    def select_4(a, b, then, otherwise):  # type: ignore[no-untyped-def]
        return (*select_3(a, b, then, otherwise), where_equal(a, b, then[3], otherwise[3]))

    return {2: select_2, 3: select_3, 4: select_4}[width]
