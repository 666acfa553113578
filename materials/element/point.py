"""A material point between two steps of an element test."""

import math
from typing import Any, NamedTuple

from grainlaw.materials.element.search import Search, search_from
from grainlaw.materials.tensor import SymmetricTensor, contraction, isotropic, trace

# Below it there is no material left, and the specific volume is no number any more [kg/m3].
SMALLEST_DENSITY = 1e-300


class Point(NamedTuple):
    """Stress [Pa], strain, strain rate [1/s], density [kg/m3] and the law's state at a time [s].

    `strain_rate` is that of the step that led here. `search` is kept because the solution of one step is the best first
    guess in the next.
    """

    time: float
    stress: SymmetricTensor
    strain: SymmetricTensor
    strain_rate: SymmetricTensor
    density: float
    state: Any
    search: Search


def is_finite(point: Point) -> bool:
    """Whether stress and density are numbers, and there is any material left."""
    return (
        math.isfinite(trace(point.stress) + contraction(point.stress, point.stress))
        and SMALLEST_DENSITY < point.density < math.inf
    )


def strain_reached(point: Point) -> str:
    """The strain of a point for messages, without the components that are zero."""
    components = (f"{name} = {value:.6g}" for name, value in point.strain._asdict().items() if value != 0.0)
    return f"strain reached: {', '.join(components) or 'none'}"


def point_at_rest(stress: SymmetricTensor, density: float, state: Any) -> Point:
    """The point at time 0, without strain."""
    nothing = isotropic(0.0)
    return Point(0.0, stress, nothing, nothing, density, state, search_from(0.0, 0.0, 0.0))
