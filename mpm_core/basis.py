"""B-spline shape functions on a regular grid, in units of the cell size.

Each basis gives, for a point at the distance f from the first node of its stencil, the weights of the `width` nodes
along one axis, and the second moment sum(w (i - f)^2), by which the affine transfer and the moving-least-squares
gradient are scaled (Jiang et al. 2015; Hu et al. 2018).

A wall lies on a line of nodes, and stencils of points near it reach a ghost node beyond. The ghost's velocity is tied
to the two nodes inside by linear extrapolation, v_ghost = 2 v_wall - v_inside, which changes the weights: twice the
ghost's weight goes to the wall node and minus its weight to the node inside. The weights that remain interpolate at the
wall and reproduce linear fields, so that no order is lost to it; the second moment loses twice the ghost's weight.
"""

from collections.abc import Callable
from dataclasses import dataclass

from numba.extending import register_jitable

from materials.compilation import named
from mpm_core.sources import CORE_MARK

# Towards a wall the moment goes to zero with the mass of the row inside, and stiffness over mass grows without bound.
# Below this value, at a twentieth of a cell from the wall, a point is taken to be that far: no explicit step that is
# stable elsewhere then fails there. Points are generated farther away than that.
SMALLEST_MOMENT_AT_WALL = 0.05


@dataclass(frozen=True)
class Basis:
    """Shape functions along one axis.

    width         number of nodes of a stencil
    offset        the first node of the stencil of a point at x is floor(x - offset)
    weights       weights of the nodes at the distance f from the first
    inverse_moment  one over the second moment of the weights about the point
    lower_wall    weights where the first node is a ghost
    upper_wall    weights where the last node is a ghost
    wall_room     the part of a cell that the changed weights leave to the node at a wall, their integral
    """

    name: str
    width: int
    offset: float
    weights: Callable[..., tuple[float, ...]]
    inverse_moment: Callable[[float], float]
    lower_wall: Callable[..., tuple[float, ...]]
    upper_wall: Callable[..., tuple[float, ...]]
    wall_room: float


@register_jitable
def linear_weights(f: float) -> tuple[float, float]:
    """Hat functions."""
    return 1.0 - f, f


@register_jitable
def inverse_linear_moment(f: float) -> float:
    """1/(f (1 - f)); the moment vanishes at the nodes together with the weight of the far node."""
    return 1.0 / max(f * (1.0 - f), 1e-12)


@register_jitable
def linear_at_wall(w: tuple[float, float]) -> tuple[float, float]:
    """Hat functions do not reach beyond a wall."""
    return w


@register_jitable
def quadratic_weights(f: float) -> tuple[float, float, float]:
    """Quadratic B-spline, f in [1/2, 3/2)."""
    return 0.5 * (1.5 - f) * (1.5 - f), 0.75 - (f - 1.0) * (f - 1.0), 0.5 * (f - 0.5) * (f - 0.5)


@register_jitable
def inverse_quadratic_moment(f: float) -> float:
    """4 everywhere."""
    return 4.0


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
def inverse_cubic_moment(f: float) -> float:
    """3 everywhere."""
    return 3.0


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
        Basis("linear", 2, 0.0, linear_weights, inverse_linear_moment, linear_at_wall, linear_at_wall, 1 / 2),
        Basis(
            "quadratic",
            3,
            0.5,
            quadratic_weights,
            inverse_quadratic_moment,
            quadratic_at_lower_wall,
            quadratic_at_upper_wall,
            13 / 24,
        ),
        Basis("cubic", 4, 1.0, cubic_weights, inverse_cubic_moment, cubic_at_lower_wall, cubic_at_upper_wall, 7 / 12),
    )
}


def make_stencil(basis: Basis) -> Callable[..., tuple[int, float, tuple[float, ...], float]]:
    """A function (grid coordinate, lower ghost, upper ghost) -> (first node, f, weights, 1/moment), for kernels."""
    width, offset, weights = basis.width, basis.offset, basis.weights
    inverse_moment, at_lower_wall, at_upper_wall = basis.inverse_moment, basis.lower_wall, basis.upper_wall

    @register_jitable
    @named(f"{basis.name}_{CORE_MARK}")
    def stencil(coordinate, lower_ghost, upper_ghost):  # type: ignore[no-untyped-def]
        # A point exactly on the upper wall belongs to the last cell.
        first = min(int(coordinate - offset), upper_ghost - width + 1)
        f = coordinate - first
        w = weights(f)
        inverse = inverse_moment(f)
        if first == lower_ghost:
            inverse = 1.0 / max(1.0 / inverse - 2.0 * w[0], SMALLEST_MOMENT_AT_WALL)
            w = at_lower_wall(w)
        elif first + width - 1 == upper_ghost:
            inverse = 1.0 / max(1.0 / inverse - 2.0 * w[width - 1], SMALLEST_MOMENT_AT_WALL)
            w = at_upper_wall(w)
        return first, f, w, inverse

    return stencil
