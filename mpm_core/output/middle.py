"""The middle of the bodies at the start in 3D, seen from above: piles spread from it, pictures show cuts through it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.space import THREE_D

HORIZONTAL = (0, 1)


@dataclass(frozen=True)
class Middle:
    """Where the bodies stand at the start in 3D, along x and along y.

    place    of the middle [m]: of the bodies, or the free-slip side where they stand, a plane of symmetry
    spreads  whether bodies can spread along the axis: not where they fill the domain from side to side
    """

    place: tuple[float, float]
    spreads: tuple[bool, bool]

    def distance(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """The horizontal way of points, shape (3, n) [m], along the axes on which bodies spread; shape (n,)."""
        along = [positions[axis] - self.place[axis] for axis in HORIZONTAL if self.spreads[axis]]
        return np.asarray(np.sqrt(sum(way**2 for way in along)))


def middle_of(scene: Scene) -> Middle | None:
    """The middle of a scene's bodies, and inflows, by their shapes; None but in 3D."""
    if scene.in_space is not THREE_D:
        return None
    corners = np.array([section.shape.bounds() for section in scene.with_points])
    return _middle(corners[:, 0].min(axis=0), corners[:, 1].max(axis=0), scene.model_dump(mode="json"))


def middle_of_points(positions: NDArray[np.float64], scene: Mapping[str, Any]) -> Middle:
    """The same by the points of a run's first frame, shape (n, 3) [m], and the tables of its scene."""
    return _middle(positions.min(axis=0), positions.max(axis=0), scene)


def _middle(lowest: NDArray[np.float64], highest: NDArray[np.float64], scene: Mapping[str, Any]) -> Middle:
    grid, sides = scene["grid"], scene["boundary"]
    found = []
    for axis, names in zip(HORIZONTAL, THREE_D.sides, strict=False):
        domain = float(grid["lower"][axis]), float(grid["upper"][axis])
        bodies = max(float(lowest[axis]), domain[0]), min(float(highest[axis]), domain[1])
        free = tuple(_is_free_slip(sides.get(name)) for name in names)
        found.append(_along(bodies, domain, free, float(grid["cell_size"])))
    places, spreads = zip(*found, strict=True)
    # Where nothing can spread, ways along x are as good as any.
    return Middle(places, spreads if any(spreads) else (True, False))


def _is_free_slip(side: Any) -> bool:
    return side is None or side["kind"] == "free_slip"


def _along(
    bodies: Sequence[float], domain: Sequence[float], free: Sequence[bool], cell_size: float
) -> tuple[float, bool]:
    """The middle along one axis [m], and whether bodies spread there."""
    touches = bodies[0] - domain[0] < cell_size, domain[1] - bodies[1] < cell_size
    if not all(touches):
        for end in (0, 1):
            if touches[end] and free[end]:
                return domain[end], True
    return 0.5 * (bodies[0] + bodies[1]), not all(touches)
