"""Surfaces of obstacles: the signed distance of a point, positive outside, and its gradient, the normal.

A surface stands in a frame of its own, in which the obstacle does not move. It is exact for shapes; for what is given
by triangles it is interpolated linearly between distances on a regular grid.
"""

import math
from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray
from shapely import Polygon, maximum_inscribed_circle

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.kernels.sources import CORE_MARK

Floats = NDArray[np.float64]


class SurfaceKind(IntEnum):
    """How the distance of a surface is found."""

    POLYGON = 0
    BALL = 1
    BOX = 2
    CYLINDER = 3
    HALF_SPACE = 4
    GRID = 5


class Surface(NamedTuple):
    """A surface: its kind and its numbers [m].

    radius     of a ball around the origin that holds it [m]
    thickness  of the largest ball that fits in [m]
    """

    kind: SurfaceKind
    numbers: Floats
    radius: float
    thickness: float


def polygon(corners: Sequence[Sequence[float]] | Floats) -> Surface:
    """A simple polygon with corners of shape (n, 2), in either order."""
    ring = np.asarray(corners, dtype=np.float64)
    x, y = ring.T
    twice_area = float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
    ordered = ring if twice_area > 0.0 else ring[::-1]
    numbers = np.ascontiguousarray(ordered).reshape(-1)
    thickness = 2.0 * maximum_inscribed_circle(Polygon(ring)).length
    return Surface(SurfaceKind.POLYGON, numbers, float(np.hypot(x, y).max()), float(thickness))


def ball(radius: float) -> Surface:
    """A disc in two axes, a sphere in three."""
    return Surface(SurfaceKind.BALL, np.array([radius]), radius, 2.0 * radius)


def box(half_lengths: Sequence[float]) -> Surface:
    """A box around the origin."""
    return Surface(
        SurfaceKind.BOX, np.array(half_lengths, np.float64), math.hypot(*half_lengths), 2.0 * min(half_lengths)
    )


def cylinder(radius: float, half_height: float) -> Surface:
    """A cylinder around the z axis, its middle in the origin."""
    thickness = 2.0 * min(radius, half_height)
    return Surface(SurfaceKind.CYLINDER, np.array([radius, half_height]), math.hypot(radius, half_height), thickness)


def half_space() -> Surface:
    """Everything below the plane z = 0, in two axes below the line y = 0."""
    return Surface(SurfaceKind.HALF_SPACE, np.empty(0), math.inf, math.inf)


def distance_grid(origin: Sequence[float], spacing: float, distances: Floats) -> Surface:
    """Signed distances on a regular grid of three axes, whose first node is at `origin` [m].

    Beyond the grid the nearest value on it counts, and how far the point is from there besides.
    """
    head = [*origin, spacing, *distances.shape]
    ends = np.array(origin) + spacing * (np.array(distances.shape) - 1)
    radius = float(np.hypot.reduce(np.maximum(np.abs(origin), np.abs(ends))))
    return Surface(SurfaceKind.GRID, np.concatenate([head, distances.ravel()]), radius, -2.0 * float(distances.min()))


@register_jitable
@named(CORE_MARK)
def _unit(axis, along):  # type: ignore[no-untyped-def]
    """A component of the unit vector along an axis, where there is no other normal."""
    return 1.0 if axis == along else 0.0


# All of these store the normal in `normal` and return the distance of the point `x`, both arrays of the axes.


@register_jitable
@named(CORE_MARK)
def _distance_of_polygon(numbers, x, normal):  # type: ignore[no-untyped-def]
    corners = len(numbers) // 2
    nearest, is_inside, sign = np.inf, False, 1.0
    for k in range(corners):
        m = (k + 1) % corners
        ax, ay, bx, by = numbers[2 * k], numbers[2 * k + 1], numbers[2 * m], numbers[2 * m + 1]
        edge_x, edge_y, to_x, to_y = bx - ax, by - ay, x[0] - ax, x[1] - ay
        edge_squared = edge_x * edge_x + edge_y * edge_y
        share = min(max((to_x * edge_x + to_y * edge_y) / edge_squared, 0.0), 1.0)
        off_x, off_y = to_x - share * edge_x, to_y - share * edge_y
        squared = off_x * off_x + off_y * off_y
        if squared < nearest:
            nearest = squared
            is_on_edge = squared <= 1e-24 * edge_squared
            # corners are in counterclockwise order
            normal[0], normal[1] = (edge_y, -edge_x) if is_on_edge else (off_x, off_y)
            sign = 0.0 if is_on_edge else 1.0
        if (ay > x[1]) != (by > x[1]) and x[0] < ax + edge_x * to_y / edge_y:
            is_inside = not is_inside
    length = np.sqrt(normal[0] * normal[0] + normal[1] * normal[1])
    out = -1.0 if is_inside and sign > 0.0 else 1.0
    normal[0], normal[1] = out * normal[0] / length, out * normal[1] / length
    return out * np.sqrt(nearest)


@register_jitable
@named(CORE_MARK)
def _distance_of_ball(numbers, x, normal):  # type: ignore[no-untyped-def]
    squared = 0.0
    for axis in range(len(x)):
        squared += x[axis] * x[axis]
    length = np.sqrt(squared)
    for axis in range(len(x)):
        normal[axis] = x[axis] / length if length > 0.0 else _unit(axis, len(x) - 1)
    return length - numbers[0]


@register_jitable
@named(CORE_MARK)
def _distance_of_box(half_lengths, x, normal):  # type: ignore[no-untyped-def]
    largest, across, squared = -np.inf, 0, 0.0
    for axis in range(len(x)):
        beyond = abs(x[axis]) - half_lengths[axis]
        normal[axis] = np.copysign(max(beyond, 0.0), x[axis])
        squared += max(beyond, 0.0) ** 2
        if beyond > largest:
            largest, across = beyond, axis
    if squared > 0.0:
        distance = np.sqrt(squared)
        for axis in range(len(x)):
            normal[axis] /= distance
        return distance
    normal[:] = 0.0
    normal[across] = np.copysign(1.0, x[across])
    return largest


@register_jitable
@named(CORE_MARK)
def _distance_of_cylinder(numbers, x, normal):  # type: ignore[no-untyped-def]
    radius = np.sqrt(x[0] * x[0] + x[1] * x[1])
    around, along = radius - numbers[0], abs(x[2]) - numbers[1]
    cosine, sine = (x[0] / radius, x[1] / radius) if radius > 0.0 else (1.0, 0.0)
    up = np.copysign(1.0, x[2])
    if around > 0.0 and along > 0.0:
        distance = np.sqrt(around * around + along * along)
        out, end = around / distance, along / distance
    else:
        distance = max(around, along)
        out, end = (1.0, 0.0) if around >= along else (0.0, 1.0)
    normal[0], normal[1], normal[2] = out * cosine, out * sine, end * up
    return distance


@register_jitable
@named(CORE_MARK)
def _distance_of_grid(numbers, x, normal):  # type: ignore[no-untyped-def]
    spacing = numbers[3]
    columns, rows = int(numbers[5]), int(numbers[6])
    first, beyond = 0, 0.0
    shares = np.empty(3)
    for axis in range(3):
        nodes = int(numbers[4 + axis])
        place = (x[axis] - numbers[axis]) / spacing
        inside = min(max(place, 0.0), nodes - 1.0)
        beyond += (spacing * (place - inside)) ** 2
        cell = min(int(inside), nodes - 2)
        shares[axis] = inside - cell
        first = first * nodes + cell
    distance = 0.0
    normal[:] = 0.0
    for corner in range(8):
        i, j, k = corner >> 2, (corner >> 1) & 1, corner & 1
        value = numbers[7 + first + (i * columns + j) * rows + k]
        wx, wy, wz = abs(1 - i - shares[0]), abs(1 - j - shares[1]), abs(1 - k - shares[2])
        distance += wx * wy * wz * value
        normal[0] += (2 * i - 1) * wy * wz * value
        normal[1] += (2 * j - 1) * wx * wz * value
        normal[2] += (2 * k - 1) * wx * wy * value
    length = np.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    for axis in range(3):
        normal[axis] = normal[axis] / length if length > 0.0 else _unit(axis, 2)
    return distance + np.sqrt(beyond)


@register_jitable
@named(CORE_MARK)
def distance_in_frame(kind, numbers, x, normal):  # type: ignore[no-untyped-def]
    """The signed distance of the point `x` in the frame of the surface; `normal` receives its gradient."""
    if kind == SurfaceKind.BALL:
        return _distance_of_ball(numbers, x, normal)
    if kind == SurfaceKind.BOX:
        return _distance_of_box(numbers, x, normal)
    if kind == SurfaceKind.HALF_SPACE:
        normal[:] = 0.0
        normal[-1] = 1.0
        return x[-1]
    if len(x) == 2:
        return _distance_of_polygon(numbers, x, normal)
    if kind == SurfaceKind.CYLINDER:
        return _distance_of_cylinder(numbers, x, normal)
    return _distance_of_grid(numbers, x, normal)
