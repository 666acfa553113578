"""A view of points in 3D: drawn by VTK in a process of its own, or where that fails by matplotlib."""

import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.image import imread
from numpy.typing import NDArray

from grainlaw.mpm_core.output.point_image import OUTLINE_IN_SPACINGS, REACH_IN_SPACINGS, ColorScale
from grainlaw.mpm_core.output.vtp import ObstacleFrame

PROGRAM = Path(__file__).with_name("render_points.py")
# Where a view is seen from: the front, with something of the right side and of the top.
DIRECTION = (0.5, -1.0, 0.6)
WINDOW = (1800, 1200)
# Lattice points of the body's surface, at most along an edge of what is shown; and where a picture is one of many.
MOST_ALONG, MOST_ALONG_QUICKLY = 160, 80
# Of the floor around the points, in their extent.
MARGIN = 0.1
# Of what the corners span, so that nothing touches the edge of a picture.
_AIR = 1.04
# A process that has not drawn a view by then [s] will not.
LONGEST_WAIT = 300.0
_SHARE_OF_WHITE = 0.995


@dataclass(frozen=True)
class View:
    """What a view shows: points of shape (n, 3) [m] in a domain of two corners [m], with their values (n,).

    corners    lowest and highest places that the picture holds, shape (2, 3) [m], for views that are compared; by
               default those of the points
    width      of the picture then [pixels]
    obstacles  seen through; of hollow ones, too, what they are around
    """

    positions: NDArray[np.float64]
    values: NDArray[np.float64]
    spacing: float
    scale: ColorScale
    domain: NDArray[np.float64]
    corners: NDArray[np.float64] | None = None
    width: int = WINDOW[0]
    obstacles: Sequence[ObstacleFrame] = ()

    @property
    def extent(self) -> NDArray[np.float64]:
        """The corners, or those of the points, shape (2, 3) [m]."""
        if self.corners is not None:
            return self.corners
        return np.array([self.positions.min(axis=0), self.positions.max(axis=0)])


def rendered(view: View) -> NDArray[np.float64] | None:
    """The image of a view, shape (rows, columns, 3), without the white around it; None where VTK cannot draw."""
    images = rendered_together([view])
    return None if images is None else _cropped(images[0])


def rendered_together(views: Sequence[View]) -> list[NDArray[np.float64]] | None:
    """The images of views, which one process draws; None where VTK cannot draw."""
    with TemporaryDirectory() as folder:
        pictures = [Path(folder) / f"view_{number:06d}.png" for number in range(len(views))]
        for view, picture in zip(views, pictures, strict=True):
            np.savez(picture.with_suffix(".npz"), **_request(view))
        # -P keeps the folder of the program, whose modules have common names, out of the path of imports.
        command = [sys.executable, "-P", str(PROGRAM), folder]
        try:
            done = subprocess.run(command, capture_output=True, timeout=LONGEST_WAIT * len(views), check=False)
            if done.returncode != 0:
                return None
            return [np.asarray(imread(picture)[..., :3], dtype=np.float64) for picture in pictures]
        except (OSError, SyntaxError, subprocess.TimeoutExpired):
            return None


def _request(view: View) -> dict[str, Any]:
    """What the program that draws is told."""
    focus, half_height, window, most_along = np.zeros(3), 0.0, WINDOW, MOST_ALONG
    if view.corners is not None:
        focus, (half_width, half_height) = _aim(view.corners)
        window, most_along = (view.width, round(view.width * half_height / half_width)), MOST_ALONG_QUICKLY
    points, faces = _triangles(view.obstacles)
    return {
        "positions": view.positions,
        "values": view.values,
        "spacing": view.spacing,
        "reach": REACH_IN_SPACINGS * view.spacing,
        "outline": OUTLINE_IN_SPACINGS * view.spacing,
        "most_along": most_along,
        "corners": view.extent,
        "margin": MARGIN,
        "direction": DIRECTION,
        "focus": focus,
        "half_height": half_height,
        "window": window,
        "limits": (view.scale.lower, view.scale.upper),
        "color_map": view.scale.map_name,
        "domain": view.domain,
        "obstacle_points": points,
        "obstacle_faces": faces,
    }


def _triangles(obstacles: Sequence[ObstacleFrame]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The corners of all obstacles, shape (n, 3) [m], and the numbers of those of each triangle."""
    points, faces, count = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
    for obstacle in obstacles:
        outline = obstacle.outline
        points.append(outline.points)
        faces.append(np.reshape(outline.faces, (-1, 3)).astype(np.int64) + count)
        count += len(outline.points)
    return np.concatenate(points), np.concatenate(faces)


def _across() -> NDArray[np.float64]:
    """What is right and what is up in a view, and what is towards it, shape (3, 3)."""
    towards = np.array(DIRECTION) / np.linalg.norm(DIRECTION)
    right = np.cross((0.0, 0.0, 1.0), towards)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(towards, right), towards])


def _aim(corners: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The place in the middle of a view of all that lies between corners, and half its width and height [m]."""
    margin = MARGIN * float(np.ptp(corners[:, :2], axis=0).max()) * np.array([1.0, 1.0, 0.0])
    ends = corners + np.array([[-1.0], [1.0]]) * margin
    axes = _across()
    seen = np.array(list(product(*ends.T))) @ axes.T
    middle = 0.5 * (seen.min(axis=0) + seen.max(axis=0))
    half = 0.5 * _AIR * np.ptp(seen[:, :2], axis=0)
    return middle @ axes, half


def view_shape(corners: NDArray[np.float64]) -> float:
    """Height over width of a view of what lies between corners, shape (2, 3) [m]."""
    half_width, half_height = _aim(corners)[1]
    return float(half_height / half_width)


def _cropped(image: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """The image without the rows and columns at its edges that are white; None where all are."""
    drawn = image.min(axis=2) < _SHARE_OF_WHITE
    if not drawn.any():
        return None
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    return image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def draw_view(figure: Figure, place: SubplotSpec, view: View, image: NDArray[np.float64] | None, width: float) -> Any:
    """Put a view into a place of a figure, `width` wide [inch]; its image, or without one its visible points."""
    if image is not None:
        axes = figure.add_subplot(place)
        draw_image(axes, image)
        return axes
    solid: Any = figure.add_subplot(place, projection="3d")
    draw_visible(solid, view, width)
    return solid


def draw_image(axes: Axes, image: NDArray[np.float64]) -> None:
    """Show the image of a view."""
    axes.imshow(image)
    axes.set_axis_off()


def draw_visible(solid: Any, view: View, width: float) -> None:
    """Draw the visible points of a view and its obstacles into axes in 3D, `width` wide [inch]."""
    extent = np.maximum(np.ptp(view.extent, axis=0), view.spacing)
    if len(view.positions):
        front = _visible(view)
        solid.scatter(
            *view.positions[front].T,
            c=view.values[front],
            cmap=view.scale.map_name,
            vmin=view.scale.lower,
            vmax=view.scale.upper,
            s=2.0 * (72.0 * width * view.spacing / np.hypot(*extent[:2])) ** 2,
            linewidths=0.0,
            depthshade=False,
        )
    points, faces = _triangles(view.obstacles)
    if len(faces):
        solid.plot_trisurf(*points.T, triangles=faces, color="0.5", alpha=0.2, linewidth=0.0)
    if view.corners is not None:
        solid.set(**{f"{name}lim": ends for name, ends in zip("xyz", view.corners.T, strict=True)})
    solid.set_box_aspect(extent)
    solid.set_proj_type("ortho")
    x, y, z = DIRECTION
    solid.view_init(elev=np.degrees(np.arctan2(z, np.hypot(x, y))), azim=np.degrees(np.arctan2(y, x)))
    solid.locator_params(nbins=5)
    solid.set(xlabel="$x$ [m]", ylabel="$y$ [m]", zlabel="$z$ [m]")


def _visible(view: View) -> NDArray[np.int64]:
    """The numbers of the points that no other one hides: in each cell across the line of sight the nearest."""
    seen = view.positions @ _across().T
    cells = np.floor(seen[:, :2] / view.spacing).astype(np.int64)
    order = np.lexsort((-seen[:, 2], cells[:, 1], cells[:, 0]))
    _, first = np.unique(cells[order], axis=0, return_index=True)
    return order[first]
