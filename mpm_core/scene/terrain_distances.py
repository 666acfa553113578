"""Signed distances from terrain in 3D on a regular grid, as `surface.distance_grid` takes them.

Near the ground they are those from its triangles. Further away a point cannot touch it, and its height over the ground,
times the cosine of the steepest slope, is a distance that is not too large.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.scene.heights import Heights
from grainlaw.mpm_core.scene.model import GridSection

Floats = NDArray[np.float64]

# Cells of the domain within which distances are exact, and cells by which the grid reaches beyond it.
NEAR, MARGIN = 3.0, 3.0
# Of the spacing of heights: by how much a domain may reach beyond their cells.
ROUND_OFF = 1e-6


def distances_of_terrain(heights: Heights, grid: GridSection, most: float) -> tuple[Floats, float, Floats]:
    """The first node [m], the spacing [m] and the distances [m] of a grid around a domain, of `most` nodes or so.

    The ground ends in the outermost layer of nodes below and beside, so that its outline is closed.
    Raises ValueError where the heights do not cover the domain.
    """
    _refuse_uncovered(heights, grid)
    cell = grid.cell_size
    lower, upper = np.array(grid.lower) - MARGIN * cell, np.array(grid.upper) + MARGIN * cell
    top = float(heights.values.max()) + (MARGIN + NEAR) * cell
    upper[2] = max(min(upper[2], top), lower[2] + 2.0 * MARGIN * cell)
    spacing = max(0.5 * cell, float((np.prod(upper - lower) / most) ** (1.0 / 3.0)))
    counts = np.ceil((upper - lower) / spacing).astype(int) + 1
    x, y, z = (low + spacing * np.arange(count) for low, count in zip(lower, counts, strict=True))
    over = z - heights.at(x, y)[:, :, np.newaxis]
    steepest = np.hypot(*(np.abs(np.diff(heights.values, axis=axis)).max() for axis in (0, 1))) / heights.spacing
    cosine = 1.0 / np.hypot(1.0, float(steepest))
    distances = over * cosine
    near = np.abs(distances) < NEAR * cell
    places = np.stack([along[numbers] for along, numbers in zip((x, y, z), np.nonzero(near), strict=True)], axis=1)
    if len(places) > 0:
        distances[near] = np.copysign(_from_triangles(heights, places, (lower, upper)), over[near])
    _end(distances, spacing)
    return lower, spacing, distances


def _refuse_uncovered(heights: Heights, grid: GridSection) -> None:
    half = (0.5 + ROUND_OFF) * heights.spacing
    for axis, name in enumerate("xy"):
        low, high = heights.lower[axis] - half, heights.upper[axis] + half
        if grid.lower[axis] < low or grid.upper[axis] > high:
            raise ValueError(
                f"its heights cover {name} = {low:g} to {high:g} m; the domain reaches from {grid.lower[axis]:g} to "
                f"{grid.upper[axis]:g} m"
            )


def _from_triangles(heights: Heights, places: Floats, corners: Sequence[Floats]) -> Floats:
    """Unsigned distances of places, shape (n, 3), from the ground, which goes on beyond the outermost heights."""
    import pyvista

    size = heights.spacing
    axes = []
    for axis in (0, 1):
        before = int(np.ceil(max(0.0, heights.lower[axis] - corners[0][axis]) / size)) + 1
        behind = int(np.ceil(max(0.0, corners[1][axis] - heights.upper[axis]) / size)) + 1
        numbers = np.arange(-before, heights.values.shape[axis] + behind)
        axes.append(heights.lower[axis] + size * numbers)
    columns, rows = map(len, axes)
    x, y = np.meshgrid(*axes, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), heights.at(*axes).ravel()])
    first = (np.arange(columns - 1)[:, np.newaxis] * rows + np.arange(rows - 1)).ravel()
    below = np.column_stack([first, first + rows, first + rows + 1])
    above = np.column_stack([first, first + rows + 1, first + 1])
    triangles = np.concatenate([below, above])
    faces = np.column_stack([np.full(len(triangles), 3), triangles]).ravel()
    found = pyvista.PolyData(places).compute_implicit_distance(pyvista.PolyData(points, faces))["implicit_distance"]
    return np.abs(np.asarray(found, np.float64))


def _end(distances: Floats, spacing: float) -> None:
    """Let no outermost node but those above lie in the ground."""
    for axis in range(3):
        along = np.moveaxis(distances, axis, 0)
        for end in (0,) if axis == 2 else (0, -1):
            along[end] = np.maximum(along[end], spacing)
