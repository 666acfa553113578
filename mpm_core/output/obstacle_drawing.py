"""Obstacles in pictures: filled grey, in the plane or on a cut through 3D, and mirrored where x is a radius."""

from collections.abc import Sequence

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Curve
from numpy.typing import NDArray

from grainlaw.mpm_core.obstacles.outline import Outline
from grainlaw.mpm_core.output.cut import Cut
from grainlaw.mpm_core.output.point_image import Box
from grainlaw.mpm_core.output.vtp import ObstacleFrame

Floats = NDArray[np.float64]
FILL, EDGE = "0.72", "0.35"
# Of the size of an obstacle.
ROUND_OFF = 1e-9


def boxes_within(obstacles: Sequence[ObstacleFrame], domain: Floats | None, cut: Cut) -> list[Box]:
    """The boxes of what lies within the domain of those obstacles that do not go from one of its sides to the other."""
    found, shown = [], [cut.across, cut.up]
    for obstacle in obstacles:
        places = obstacle.outline.points[:, shown]
        if len(places) == 0 or obstacle.hollow or domain is None:
            continue
        lowest, highest = places.min(axis=0), places.max(axis=0)
        goes_through = (lowest <= domain[0, shown]) & (highest >= domain[1, shown])
        lowest, highest = np.maximum(lowest, domain[0, shown]), np.minimum(highest, domain[1, shown])
        if not goes_through.any() and (lowest < highest).all():
            left = -float(highest[0]) if cut.is_mirrored else float(lowest[0])
            found.append((left, float(highest[0]), float(lowest[1]), float(highest[1])))
    return found


def draw_obstacles(axes: Axes, obstacles: Sequence[ObstacleFrame], cut: Cut, box: Box) -> None:
    """Fill what obstacles take of a picture of a box [m]; all around its outline of a hollow one."""
    left, right, bottom, top = box
    frame = np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
    # Beyond the edge of the picture, where no line is to be seen.
    frame = frame + 0.1 * (frame - frame.mean(axis=0))
    for obstacle in obstacles:
        loops = loops_of(obstacle.outline, cut)
        if cut.is_mirrored:
            loops = [*loops, *(loop[::-1] * [-1.0, 1.0] for loop in loops)]
        if obstacle.hollow:
            loops = [frame, *(_turned(loop, -1.0) for loop in loops)]
        if loops:
            curve = Curve.make_compound_path(*(Curve(np.vstack([loop, loop[:1]]), closed=True) for loop in loops))
            axes.add_patch(PathPatch(curve, facecolor=FILL, edgecolor=EDGE, linewidth=0.8, zorder=0.5))


def _turned(loop: Floats, way: float) -> Floats:
    """A loop that goes round counterclockwise (1), or clockwise (-1), so that it is a hole."""
    x, y = loop.T
    twice_area = float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
    return loop if twice_area * way > 0.0 else loop[::-1]


def loops_of(outline: Outline, cut: Cut) -> list[Floats]:
    """The closed lines of an outline in the plane, or where a cut meets it."""
    if not outline.faces:
        return []
    if cut.normal is None:
        return [outline.points[face][:, [cut.across, cut.up]] for face in outline.faces]
    from trimesh import Trimesh
    from trimesh.intersections import mesh_plane

    solid, normal = Trimesh(outline.points, np.array(outline.faces)), np.eye(3)[cut.normal]
    edges = np.asarray(mesh_plane(solid, normal, cut.place * normal))[:, :, [cut.across, cut.up]]
    if len(edges) == 0:
        return []
    # Edges of neighbouring triangles meet but for round-off.
    spacing = ROUND_OFF * float(np.abs(outline.points).max())
    lines = shapely.multilinestrings(shapely.set_precision(shapely.linestrings(edges), spacing, mode="pointwise"))
    areas = shapely.get_parts(shapely.build_area(lines))
    rings = [(area.exterior, 1.0) for area in areas]
    rings += [(hole, -1.0) for area in areas for hole in area.interiors]
    return [_turned(np.array(ring.coords)[:-1], way) for ring, way in rings]
