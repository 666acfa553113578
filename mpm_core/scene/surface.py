"""Which points lie inside a closed surface of triangles, so that bodies that share a face share no point.

On the way from a point to infinity the surface is crossed outwards once more than inwards if the point is inside. A way
through a hole miscounts. If there are small holes, six ways, up and down along x, y and z, decide by their majority.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.mpm_core.scene.outline import Points, off_edges
from grainlaw.mpm_core.scene.triangles import areas_in_space, distinct, encloses_volume, node_numbers

Integers = NDArray[np.int64]

# Of the area of a surface, that may be missing.
LARGEST_HOLES = 1e-3
# Pairs of a triangle and a line that are looked at together.
PAIRS_AT_ONCE = 2**22
# Of the largest coordinate: more than points are shifted off edges.
MARGIN = 2.0**-34


class Surface(NamedTuple):
    """Triangles, shape (m, 3, 3) [m], which all face outwards or all inwards; and whether they leave holes."""

    triangles: Points
    has_holes: bool
    source: str

    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The box around the triangles."""
        corners = self.triangles.reshape(-1, 3)
        return tuple(corners.min(axis=0).tolist()), tuple(corners.max(axis=0).tolist())

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Inside, or on the lower, left and front sides. Raises InputError where the surface encloses a point twice."""
        axes = (0, 1, 2) if self.has_holes else (2,)
        counts = np.concatenate([_times_enclosed(self.triangles, points, axis) for axis in axes])
        times = np.abs(np.median(counts, axis=0))
        if (times > 1.5).any():
            x, y, z = points[np.argmax(times > 1.5)]
            raise InputError(
                f"{self.source}: parts of the surface overlap, or a cavity's triangles face outwards, at "
                f"({x:g}, {y:g}, {z:g})"
            )
        return np.asarray(times > 0.5)


def closed_surface(triangles: Points, source: str) -> Surface:
    """The surface of triangles, shape (m, 3, 3) [m].

    Raises ValueError if it is not closed but for small holes, if neighbours face opposite ways, and if it encloses no
    volume.
    """
    nodes = node_numbers(triangles)
    ends = np.stack([nodes, np.roll(nodes, -1, axis=1)], axis=2).reshape(-1, 2)
    places = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2, 3)
    is_edge = ends[:, 0] != ends[:, 1]
    ends, places = ends[is_edge], places[is_edge]
    found = distinct(np.sort(ends, axis=1))
    runs = np.bincount(found.which, np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0))
    opposed = (found.uses % 2 == 0) & (runs != 0.0)
    if opposed.any():
        raise ValueError(f"{source}: at {opposed.sum()} edges of the surface neighbours face opposite ways")
    is_open = found.uses % 2 == 1
    if is_open.any():
        edges = found.first[is_open]
        _refuse_large_holes(places[edges], ends[edges], float(areas_in_space(triangles).sum()), source)
    if not encloses_volume(triangles):
        raise ValueError(f"{source}: the surface encloses no volume")
    return Surface(triangles, bool(is_open.any()), source)


def _refuse_large_holes(places: Points, edges: Integers, whole: float, source: str) -> None:
    """Each hole is closed from its open edges, shape (e, 2, 3), to the middle of them; `edges` has their nodes."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = int(edges.max()) + 1
    links = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count))
    part = connected_components(links, directed=False)[1][edges[:, 0]]
    _, hole, size = np.unique(part, return_inverse=True, return_counts=True)
    middle = np.stack([np.bincount(hole, places[:, :, axis].mean(axis=1)) for axis in range(3)], axis=1) / size[:, None]
    missing = areas_in_space(np.concatenate([places, middle[hole][:, None]], axis=1))
    if missing.sum() > LARGEST_HOLES * whole:
        x, y, z = middle[np.argmax(np.bincount(hole, missing))]
        raise ValueError(
            f"{source} is a surface in space that is not closed: {len(edges)} edges belong to one triangle only, most "
            f"around ({x:g}, {y:g}, {z:g}); allowed: holes of {LARGEST_HOLES:.1%} of the surface, not "
            f"{missing.sum() / whole:.2%}"
        )


def _times_enclosed(triangles: Points, points: Points, axis: int) -> Integers:
    """How many more crossings lead out than in from each point up and down an axis, shape (2, n)."""
    across = [(axis + 1) % 3, (axis + 2) % 3]
    lines = distinct(points[:, across])
    found = list(_crossings(triangles, points[lines.first][:, across], axis))
    line = np.concatenate([lines.which, *(crossed for crossed, _, _ in found)])
    place = np.concatenate([off_edges(points)[:, axis], *(places for _, places, _ in found)])
    outwards = np.concatenate([np.zeros(len(points), np.int64), *(signs for _, _, signs in found)])
    order = np.lexsort((-place, line))
    so_far = np.cumsum(outwards[order])
    begins = np.flatnonzero(np.diff(line[order], prepend=-1))
    lengths = np.diff(np.append(begins, len(order)))
    before = np.repeat((so_far - outwards[order])[begins], lengths)
    all_of_line = np.repeat(so_far[begins + lengths - 1], lengths) - before
    times = np.empty((2, len(order)), np.int64)
    # A point itself is no crossing: what is not above it lies below, where outwards is down.
    times[:, order] = so_far - before, so_far - before - all_of_line
    return times[:, : len(points)]


def _crossings(triangles: Points, lines: Points, axis: int) -> Iterator[tuple[Integers, Points, Integers]]:
    """Numbers of lines along an axis, the places where triangles cross them [m], and 1 if outwards there, else -1.

    `lines` has the coordinates across the axis, shape (l, 2) [m]. A triangle, and each of its edges, is met with its
    corners in the same order whichever body it belongs to: neighbours leave no line out and share none.
    """
    across = [(axis + 1) % 3, (axis + 2) % 3]
    order = np.lexsort(np.moveaxis(triangles[:, :, ::-1], 2, 0), axis=1)
    corners = np.take_along_axis(triangles, order[:, :, None], axis=1)
    is_turned = np.linalg.det(np.eye(3)[order]) < 0.0
    flat = corners[:, :, across]
    shifted = off_edges(lines, across)
    for triangle, line in _pairs(flat, lines):
        (x, y), here = shifted[line].T, np.moveaxis(flat[triangle], (1, 2), (0, 1))
        sides = [
            (here[b, 0] - here[a, 0]) * (y - here[a, 1]) - (here[b, 1] - here[a, 1]) * (x - here[a, 0])
            for a, b in ((0, 1), (1, 2), (0, 2))
        ]
        left = [side > 0.0 for side in sides]
        inside = (left[0] == left[1]) & (left[0] != left[2])
        first, second, third = (side[inside] for side in sides)
        along = corners[triangle[inside], :, axis].T
        rise = first * (along[2] - along[0]) - third * (along[1] - along[0])
        faces = np.where(left[0][inside] != is_turned[triangle[inside]], 1, -1)
        yield line[inside], along[0] + rise / (first + second - third), faces


def _pairs(flat: Points, lines: Points) -> Iterator[tuple[Integers, Integers]]:
    """Numbers of triangles, shape (m, 3, 2) across the lines [m], and of lines within the rectangles around them."""
    values, places = zip(*(np.unique(lines[:, axis], return_inverse=True) for axis in (0, 1)), strict=True)
    numbers = np.full((len(values[0]), len(values[1])), -1)
    numbers[places[0].ravel(), places[1].ravel()] = np.arange(len(lines))
    margin = MARGIN * float(np.abs(lines).max(initial=1.0))
    first = [np.searchsorted(values[axis], flat[:, :, axis].min(axis=1) - margin) for axis in (0, 1)]
    count = [np.searchsorted(values[axis], flat[:, :, axis].max(axis=1) + margin) - first[axis] for axis in (0, 1)]
    pairs = count[0] * count[1]
    group = np.cumsum(pairs) // PAIRS_AT_ONCE
    for members in np.split(np.arange(len(flat)), np.flatnonzero(np.diff(group)) + 1):
        triangle = np.repeat(members, pairs[members])
        inner = np.arange(len(triangle)) - np.repeat(np.cumsum(pairs[members]) - pairs[members], pairs[members])
        row, column = np.divmod(inner, np.maximum(count[1][triangle], 1))
        line = numbers[first[0][triangle] + row, first[1][triangle] + column]
        yield triangle[line >= 0], line[line >= 0]
