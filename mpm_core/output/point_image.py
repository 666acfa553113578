"""Points drawn as the solid body that they stand for: an image whose pixels take the value of the nearest point."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.image import AxesImage
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from grainlaw.mpm_core.output.cut import PLANE, Cut

# Points up to two reaches apart belong to one body. Stretching draws a lattice of points apart to three spacings and
# more while they still share grid nodes; what opens wider than four is drawn as a crack.
REACH_IN_SPACINGS = 2.0
# Half a spacing beyond the outermost points lies the surface; the quarter more evens out the scallops between them.
OUTLINE_IN_SPACINGS = 0.75
_FLOOR_TOLERANCE = 0.02
# A cut through 3D shares the width of a picture with others.
_PIXELS_ACROSS, _PIXELS_ACROSS_CUT = 900, 600
# None of them on the colour map, from black over copper to light brown.
_OUTLINE_COLORS = ("tab:blue", "tab:green", "tab:red", "tab:purple", "tab:cyan", "tab:pink")
OUTLINE_COLORS = len(_OUTLINE_COLORS)
_OUTLINE_WIDTH = 1.0
_POINTS_SAMPLED = 5000

Box = tuple[float, float, float, float]
"""Left, right, bottom and top [m]."""


@dataclass(frozen=True)
class ColorScale:
    """Name of the colour map and the values at its two ends."""

    map_name: str
    lower: float
    upper: float

    def mappable(self) -> ScalarMappable:
        """What a colour bar needs of it."""
        return ScalarMappable(Normalize(self.lower, self.upper), self.map_name)


def point_spacing(positions: NDArray[np.float64]) -> float:
    """Median distance [m] from a point to its nearest neighbour; for freshly generated points, their spacing.

    A single point has none: 1 m.
    """
    if len(positions) < 2:
        return 1.0
    sampled = positions[:: max(1, len(positions) // _POINTS_SAMPLED)]
    distances, _ = cKDTree(positions).query(sampled, k=2)
    return float(np.median(distances[:, 1]))


def bounding_box(positions: NDArray[np.float64], spacing: float, cut: Cut = PLANE) -> Box:
    """Left, right, bottom and top [m] of the body: each point reaches half a spacing around itself.

    On a cut it is that of the whole body, seen along the normal.
    """
    places = positions[:, [cut.across, cut.up]]
    (left, bottom), (right, top) = places.min(axis=0), places.max(axis=0)
    if cut.is_mirrored:
        left = -right
    return left - spacing / 2, right + spacing / 2, bottom - spacing / 2, top + spacing / 2


def view_box(boxes: Sequence[Box]) -> Box:
    """Left, right, bottom, top [m] that hold all the boxes, with some air beside and above them.

    A body that stands on 0, but for the half spacing of its lowest points, is shown from there.
    """
    lowest, highest = np.min(boxes, axis=0), np.max(boxes, axis=0)
    left, right, bottom, top = lowest[0], highest[1], lowest[2], highest[3]
    if abs(bottom) < _FLOOR_TOLERANCE * (top - bottom):
        bottom = 0.0
    return left - 0.03 * (right - left), right + 0.03 * (right - left), bottom, top + 0.1 * (top - bottom)


def draw_points(
    axes: Axes,
    positions: NDArray[np.float64],
    values: NDArray[np.float64],
    spacing: float,
    scale: ColorScale,
    groups: NDArray[np.int64] | None = None,
    cut: Cut = PLANE,
    pixel: float | None = None,
) -> AxesImage:
    """Draw points of shape (points, 3), coloured by values of shape (points,), in the x-y plane or on a cut.

    `groups`, shape (points,), are numbers of materials: each is drawn with an outline of its own colour.
    Everything outside the body stays blank. The cost grows with the pixels, hardly with the points; `pixel` is the
    edge of one [m], by default so that there are enough of them for a picture of the paper's width.
    """
    left, right, bottom, top = bounding_box(positions, spacing, cut)
    if pixel is None:
        across = _PIXELS_ACROSS if cut.normal is None else _PIXELS_ACROSS_CUT
        pixel = max(right - left, top - bottom) / across
    reach = max(REACH_IN_SPACINGS * spacing, 2.0 * pixel)
    x = np.arange(left - reach - pixel, right + reach + pixel, pixel)
    y = np.arange(bottom - reach - pixel, top + reach + pixel, pixel)
    shown = cut.points_within(reach, positions)
    centers = np.stack(np.meshgrid(x, y, *[0.0] * (shown.places.shape[1] - 2)), axis=-1).reshape(len(y), len(x), -1)
    distances, nearest = cKDTree(shown.places).query(centers, distance_upper_bound=reach)
    # Grown by the reach, then shrunk back to the outline: gaps close, the outline stays.
    grown = np.isfinite(distances)
    solid = distance_transform_edt(grown, sampling=pixel) > reach - max(OUTLINE_IN_SPACINGS * spacing, pixel)
    # Of a body that the cut misses no pixel is solid, and any point stands for them.
    numbers = shown.numbers if len(shown.numbers) else np.zeros(1, np.int64)
    point = numbers[np.where(grown, nearest, 0)]
    half = pixel / 2
    image = axes.imshow(
        np.ma.masked_array(values[point], mask=~solid),
        extent=(x[0] - half, x[-1] + half, y[0] - half, y[-1] + half),
        origin="lower",
        interpolation="nearest",
        cmap=scale.map_name,
        vmin=scale.lower,
        vmax=scale.upper,
        aspect="equal",
    )
    if groups is not None:
        for group in np.unique(groups[point[solid]]):
            region = solid & (groups[point] == group)
            axes.contour(x, y, region, [0.5], colors=[outline_color(group)], linewidths=_OUTLINE_WIDTH)
    return image


def outline_color(group: int) -> str:
    """The colour of the outline of a material, by its number."""
    return _OUTLINE_COLORS[group % len(_OUTLINE_COLORS)]
