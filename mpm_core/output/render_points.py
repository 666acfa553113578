"""Points in 3D drawn by VTK as the solid body that they stand for: `python render_points.py REQUEST PICTURE`.

It is a program of its own: where a machine cannot draw, VTK ends the process, which must not be that of the run. The
request is the NPZ file that `rendering.rendered` writes.
"""

import sys
from typing import Any

import numpy as np
import pyvista
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

WINDOW = (1800, 1200)
ZOOM = 1.2
# Lattice points per spacing of the points, and at most along an edge of what is shown.
FINENESS, MOST_ALONG = 2.0, 160
ROUNDS_OF_SMOOTHING = 20
# Of the floor around the points, in their extent.
MARGIN = 0.1
FLOOR_COLOR = "#d9d9d9"


def render(request: str, picture: str) -> None:
    """Draw the points of a request into a PNG file."""
    with np.load(request) as given:
        positions, values, domain = given["positions"], given["values"], given["domain"]
        reach, outline, spacing = (float(given[name]) for name in ("reach", "outline", "spacing"))
        direction, limits, color_map = given["direction"], given["limits"], str(given["color_map"])
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=list(WINDOW))
    plotter.background_color = "white"
    body = surface_of(positions, spacing, reach, outline, domain)
    body["shown"] = values[cKDTree(positions).query(body.points)[1]]
    colors = {"cmap": color_map, "clim": limits.tolist(), "show_scalar_bar": False}
    plotter.add_mesh(body, scalars="shown", smooth_shading=True, ambient=0.25, diffuse=0.8, **colors)
    shown = body.bounds
    floor = floor_of(positions, domain, spacing)
    if floor is not None:
        plotter.add_mesh(floor, color=FLOOR_COLOR, lighting=False)
        shown = floor.merge(body).bounds
    plotter.add_axes(color="black", line_width=3, viewport=(0.0, 0.0, 0.16, 0.24))
    plotter.enable_parallel_projection()
    plotter.camera_position = [tuple(direction), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    plotter.reset_camera(bounds=shown)
    plotter.camera.zoom(ZOOM)
    plotter.screenshot(picture)


def surface_of(
    positions: NDArray[np.float64], spacing: float, reach: float, outline: float, domain: NDArray[np.float64]
) -> Any:
    """The surface of the body: grown by the `reach` of its points, then shrunk back to their `outline` [m].

    So gaps between points that stretching drew apart close, and the surface stays where it is.
    """
    lowest, highest = positions.min(axis=0), positions.max(axis=0)
    edge = max(spacing / FINENESS, float((highest - lowest).max()) / MOST_ALONG)
    reach, outline = max(reach, 3.0 * edge), max(outline, edge)
    first = lowest - reach - 2.0 * edge
    counts = np.ceil((highest + reach + 2.0 * edge - first) / edge).astype(int)
    axes = [first[axis] + edge * np.arange(counts[axis]) for axis in range(3)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    distances, _ = cKDTree(positions).query(places, distance_upper_bound=reach)
    level = distance_transform_edt(np.isfinite(distances), sampling=edge) - (reach - outline)
    lattice: Any = pyvista.ImageData(dimensions=tuple(counts), spacing=(edge,) * 3, origin=tuple(first))
    lattice["level"] = level.ravel(order="F")
    surface = lattice.contour([0.0], scalars="level").smooth_taubin(n_iter=ROUNDS_OF_SMOOTHING)
    surface.points = np.clip(surface.points, domain[0], domain[1])
    return surface


def floor_of(positions: NDArray[np.float64], domain: NDArray[np.float64], spacing: float) -> Any:
    """The part of the domain's floor on which the points stand; None where they are above it."""
    lowest, highest = positions.min(axis=0), positions.max(axis=0)
    if lowest[2] - domain[0, 2] > 2.0 * spacing:
        return None
    margin = MARGIN * float((highest - lowest)[:2].max())
    lower, upper = np.maximum(lowest - margin, domain[0])[:2], np.minimum(highest + margin, domain[1])[:2]
    corners = [(lower[0], lower[1]), (upper[0], lower[1]), (upper[0], upper[1]), (lower[0], upper[1])]
    return pyvista.PolyData(np.array([(*corner, domain[0, 2]) for corner in corners]), faces=[4, 0, 1, 2, 3])


if __name__ == "__main__":
    render(*sys.argv[1:3])
