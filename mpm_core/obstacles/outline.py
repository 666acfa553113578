"""What an obstacle looks like: polygons in two axes, triangles in three, in the part of space that a domain shows."""

from collections.abc import Sequence
from itertools import combinations, product
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray
from shapely import Polygon, box, get_parts

from grainlaw.mpm_core.obstacles.obstacle import Obstacle
from grainlaw.mpm_core.obstacles.surface import Surface, SurfaceKind

Floats = NDArray[np.float64]
# Corners of a circle, and of half of one from pole to pole.
AROUND, FROM_POLE_TO_POLE = 64, 32


class Outline(NamedTuple):
    """Corners, shape (n, 3) [m], and the numbers of the corners of each polygon or triangle."""

    points: Floats
    faces: list[NDArray[np.int64]]


def outline_of(obstacle: Obstacle, lower: Sequence[float], upper: Sequence[float]) -> Outline:
    """The outline of an obstacle where it is; of what reaches beyond a domain in two axes, and of planes, that part.

    `lower` and `upper` are the corners of the domain [m].
    """
    surface, pose = obstacle.surface, obstacle.motion.pose
    if surface.kind == SurfaceKind.HALF_SPACE and len(lower) == 3:
        return _behind_plane(pose.position, pose.rotation[:, 2], np.array([lower, upper]))
    in_frame = _in_frame(surface, len(lower), 4.0 * float(np.linalg.norm(np.subtract(upper, lower))))
    placed = Outline(in_frame.points @ pose.rotation.T + pose.position, in_frame.faces)
    return placed if len(lower) == 3 else _clipped(placed, lower, upper)


def _in_frame(surface: Surface, axes: int, far: float) -> Outline:
    if surface.kind == SurfaceKind.GRID:
        return _of_grid(surface.numbers)
    return _flat(_corners_in_plane(surface, far)) if axes == 2 else _hull(_corners_in_3d(surface))


def _corners_in_plane(surface: Surface, far: float) -> Floats:
    if surface.kind == SurfaceKind.BALL:
        return surface.numbers[0] * _circle()
    if surface.kind == SurfaceKind.HALF_SPACE:
        return far * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 0.0), (-1.0, 0.0)])
    return surface.numbers.reshape(-1, 2)


def _corners_in_3d(surface: Surface) -> Floats:
    numbers = surface.numbers
    if surface.kind == SurfaceKind.BOX:
        return np.array(list(product(*[(-half, half) for half in numbers])))
    if surface.kind == SurfaceKind.CYLINDER:
        ring = numbers[0] * _circle()
        return np.concatenate([np.column_stack([ring, np.full(AROUND, z)]) for z in (-numbers[1], numbers[1])])
    angles = np.pi * np.arange(FROM_POLE_TO_POLE + 1) / FROM_POLE_TO_POLE
    rings = [np.column_stack([np.sin(a) * _circle(), np.full(AROUND, np.cos(a))]) for a in angles[1:-1]]
    return np.asarray(numbers[0] * np.concatenate([[(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)], *rings]))


def _circle() -> Floats:
    angles = 2.0 * np.pi * np.arange(AROUND) / AROUND
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _flat(corners: Floats) -> Outline:
    return Outline(np.pad(corners, ((0, 0), (0, 1))), [np.arange(len(corners))])


def _hull(points: Floats) -> Outline:
    """The triangles of a convex solid, their corners in the order that makes normals point outwards."""
    hull = scipy.spatial.ConvexHull(points)
    faces = []
    for simplex, equation in zip(hull.simplices.astype(np.int64), hull.equations, strict=True):
        a, b, c = points[simplex]
        faces.append(simplex if np.cross(b - a, c - a) @ equation[:3] > 0.0 else simplex[::-1])
    return Outline(points, faces)


def _behind_plane(point: Floats, normal: Floats, domain: Floats) -> Outline:
    """The part of a domain behind a plane."""
    corners = np.array(list(product(*domain.T)))
    heights = (corners - point) @ normal
    # A plane beside the domain may leave nothing, or less than a solid.
    cut = [corners[heights <= 0.0]]
    for a, b in combinations(range(8), 2):
        if np.count_nonzero(corners[a] != corners[b]) == 1 and heights[a] * heights[b] < 0.0:
            share = heights[a] / (heights[a] - heights[b])
            cut.append(corners[[a]] + share * (corners[[b]] - corners[[a]]))
    points = np.concatenate(cut)
    if len(points) < 4 or np.linalg.matrix_rank(points - points[0], tol=1e-9) < 3:
        return Outline(np.empty((0, 3)), [])
    return _hull(points)


def _clipped(outline: Outline, lower: Sequence[float], upper: Sequence[float]) -> Outline:
    points: list[Floats] = []
    faces: list[NDArray[np.int64]] = []
    for part in get_parts(Polygon(outline.points[:, :2]).intersection(box(*lower, *upper))):
        if isinstance(part, Polygon) and not part.is_empty:
            corners = np.array(part.exterior.coords)[:-1]
            faces.append(np.arange(len(corners)) + sum(map(len, points)))
            points.append(np.pad(corners, ((0, 0), (0, 1))))
    return Outline(np.concatenate(points) if points else np.empty((0, 3)), faces)


def _of_grid(numbers: Floats) -> Outline:
    """The surface where interpolated distances are zero."""
    import pyvista

    shape = tuple(int(count) for count in numbers[4:7])
    image = pyvista.ImageData(dimensions=shape, spacing=(numbers[3],) * 3, origin=tuple(numbers[:3]))
    image["distance"] = numbers[7:].reshape(shape).ravel(order="F")
    found = image.contour([0.0], scalars="distance")
    return Outline(np.asarray(found.points, np.float64), list(found.faces.reshape(-1, 4)[:, 1:].astype(np.int64)))
