"""A view of points in 3D: drawn by VTK in a process of its own, or where that fails by matplotlib."""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.image import imread
from numpy.typing import NDArray

from grainlaw.mpm_core.output.point_image import OUTLINE_IN_SPACINGS, REACH_IN_SPACINGS, ColorScale

PROGRAM = Path(__file__).with_name("render_points.py")
# Where a view is seen from: the front, with something of the right side and of the top.
DIRECTION = (0.5, -1.0, 0.6)
# A process that has not drawn by then [s] will not.
LONGEST_WAIT = 300.0
_SHARE_OF_WHITE = 0.995


@dataclass(frozen=True)
class View:
    """What a view shows: points of shape (n, 3) [m] in a domain of two corners [m], with their values (n,)."""

    positions: NDArray[np.float64]
    values: NDArray[np.float64]
    spacing: float
    scale: ColorScale
    domain: NDArray[np.float64]


def rendered(view: View) -> NDArray[np.float64] | None:
    """The image of a view, shape (rows, columns, 3), without the white around it; None where VTK cannot draw."""
    with TemporaryDirectory() as folder:
        request, picture = Path(folder) / "request.npz", Path(folder) / "view.png"
        np.savez(
            request,
            positions=view.positions,
            values=view.values,
            spacing=view.spacing,
            reach=REACH_IN_SPACINGS * view.spacing,
            outline=OUTLINE_IN_SPACINGS * view.spacing,
            direction=DIRECTION,
            limits=(view.scale.lower, view.scale.upper),
            color_map=view.scale.map_name,
            domain=view.domain,
        )
        # -P keeps the folder of the program, whose modules have common names, out of the path of imports.
        command = [sys.executable, "-P", str(PROGRAM), str(request), str(picture)]
        try:
            done = subprocess.run(command, capture_output=True, timeout=LONGEST_WAIT, check=False)
            image = imread(picture) if done.returncode == 0 and picture.is_file() else None
        except (OSError, SyntaxError, subprocess.TimeoutExpired):
            return None
    return None if image is None else _cropped(np.asarray(image[..., :3], dtype=np.float64))


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
        axes.imshow(image)
        axes.set_axis_off()
        return axes
    solid: Any = figure.add_subplot(place, projection="3d")
    front = _visible(view)
    extent = np.maximum(np.ptp(view.positions, axis=0), view.spacing)
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
    solid.set_box_aspect(extent)
    solid.set_proj_type("ortho")
    x, y, z = DIRECTION
    solid.view_init(elev=np.degrees(np.arctan2(z, np.hypot(x, y))), azim=np.degrees(np.arctan2(y, x)))
    solid.locator_params(nbins=5)
    solid.set(xlabel="$x$ [m]", ylabel="$y$ [m]", zlabel="$z$ [m]")
    return solid


def _visible(view: View) -> NDArray[np.int64]:
    """The numbers of the points that no other one hides: in each cell across the line of sight the nearest."""
    towards = np.array(DIRECTION) / np.linalg.norm(DIRECTION)
    right = np.cross((0.0, 0.0, 1.0), towards)
    right /= np.linalg.norm(right)
    across = view.positions @ np.column_stack([right, np.cross(towards, right)])
    cells = np.floor(across / view.spacing).astype(np.int64)
    order = np.lexsort((-(view.positions @ towards), cells[:, 1], cells[:, 0]))
    _, first = np.unique(cells[order], axis=0, return_index=True)
    return order[first]
