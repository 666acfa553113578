"""Which points lie inside closed outlines, so that regions that share an edge share no point and lose none."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

# A point on an edge belongs to the region on its right, or above it. The shift is far above round-off of coordinates
# and far below a cell, and its direction is that of no edge in use (in the plane 37 degrees).
SHIFT = 2.0**-36 * np.array([1.0, 0.7548776662466927, 0.5698402909980532])


def off_edges(points: Points, along: Sequence[int] = (0, 1, 2)) -> Points:
    """The points, shape (n, axes) [m], shifted by far less than a cell: none lies on an edge or a face any more.

    The shift depends on the point alone, so that every region decides alike about a point on a common edge. `along` are
    the axes of the coordinates.
    """
    scale = np.abs(points).max(axis=1, initial=1.0)
    return points + scale[:, None] * SHIFT[list(along[: points.shape[1]])]


def closed_edges(corners: Points) -> Points:
    """The edges x0, y0, x1, y1 of outlines, shape (m, 4) [m]; corners has the shape (outlines, corners, 2)."""
    return np.concatenate([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 4)


def outer_edges(edges: Points) -> Points:
    """The edges, each from its lower to its upper end, without those that occur an even number of times."""
    upwards = (edges[:, 1] < edges[:, 3]) | ((edges[:, 1] == edges[:, 3]) & (edges[:, 0] < edges[:, 2]))
    ordered = np.where(upwards[:, None], edges, edges[:, [2, 3, 0, 1]])
    distinct, count = np.unique(ordered, axis=0, return_counts=True)
    return distinct[count % 2 == 1]


def enclosed(points: Points, edges: Points) -> NDArray[np.bool_]:
    """Which of the points, shape (n, 2) [m], lie inside the edges of `outer_edges`, by the even-odd rule.

    A ray to the right crosses an edge or not by the edge alone, whichever region it belongs to (M. Shimrat,
    Algorithm 112, Communications of the ACM 5, 1962).
    """
    shifted = off_edges(points)
    order = np.argsort(shifted[:, 1], kind="stable")
    x, y = shifted[order].T
    inside = np.zeros(len(points), dtype=bool)
    first, last = np.searchsorted(y, edges[:, 1]), np.searchsorted(y, edges[:, 3])
    for (x0, y0, x1, y1), start, stop in zip(edges.tolist(), first.tolist(), last.tolist(), strict=True):
        beside = slice(start, stop)
        inside[beside] ^= (x1 - x0) * (y[beside] - y0) > (x[beside] - x0) * (y1 - y0)
    found = np.empty_like(inside)
    found[order] = inside
    return found


def areas(corners: Points) -> NDArray[np.float64]:
    """The areas of cells [m2], shape (cells,); corners has the shape (cells, corners, 2)."""
    x, y = np.moveaxis(corners - corners[:, :1], 2, 0)
    return np.asarray(np.abs((x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)) / 2)


def enclosed_area(edges: Points) -> float:
    """The area [m2] inside the edges of `outer_edges`; cells that overlap have a larger sum of areas."""
    from shapely import area, get_coordinates, get_parts, linestrings, point_on_surface, polygonize, union_all

    faces = get_parts(polygonize(get_parts(union_all(linestrings(edges.reshape(-1, 2, 2))))))
    return float(area(faces)[enclosed(get_coordinates(point_on_surface(faces)), edges)].sum())
