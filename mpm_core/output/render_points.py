"""Points in 3D drawn by VTK as the solid body that they stand for: `python render_points.py FOLDER`.

It is a program of its own: where a machine cannot draw, VTK ends the process, which must not be that of the run. Each
request in the folder is an NPZ file that `rendering.rendered_together` writes; its picture gets the same name.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyvista
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

ZOOM = 1.2
# Lattice points per spacing of the points.
FINENESS = 2.0
ROUNDS_OF_SMOOTHING = 20
FLOOR_COLOR = "#d9d9d9"
# What an obstacle hides is seen through it.
OBSTACLE_COLOR, OBSTACLE_OPACITY = "#8c8c8c", 0.3


def render(request: Path) -> None:
    """Draw the points of a request into a PNG file."""
    with np.load(request) as file:
        given = dict(file)
    positions, corners, domain, spacing = (given[name] for name in ("positions", "corners", "domain", "spacing"))
    plotter: Any = pyvista.Plotter(off_screen=True, window_size=given["window"].tolist())
    plotter.background_color = "white"
    shown = tuple(corners.T.ravel())
    if len(positions):
        reach, outline, most_along = (float(given[name]) for name in ("reach", "outline", "most_along"))
        body = surface_of(positions, float(spacing), reach, outline, domain, most_along)
        body["shown"] = given["values"][cKDTree(positions).query(body.points)[1]]
        colors = {"cmap": str(given["color_map"]), "clim": given["limits"].tolist(), "show_scalar_bar": False}
        plotter.add_mesh(body, scalars="shown", smooth_shading=True, ambient=0.25, diffuse=0.8, **colors)
        shown = body.bounds
    floor = floor_of(corners, domain, float(spacing), float(given["margin"]))
    if floor is not None:
        plotter.add_mesh(floor, color=FLOOR_COLOR, lighting=False)
        shown = floor.merge(body).bounds if len(positions) else floor.bounds
    if len(given["obstacle_faces"]):
        faces = np.pad(given["obstacle_faces"], ((0, 0), (1, 0)), constant_values=3)
        obstacles = pyvista.PolyData(given["obstacle_points"], faces=faces.ravel())
        plotter.add_mesh(obstacles, color=OBSTACLE_COLOR, opacity=OBSTACLE_OPACITY)
    plotter.add_axes(color="black", line_width=3, viewport=(0.0, 0.0, 0.16, 0.24))
    plotter.enable_parallel_projection()
    aim(plotter, given, shown)
    plotter.screenshot(str(request.with_suffix(".png")))


def aim(plotter: Any, given: dict[str, NDArray[np.float64]], shown: tuple[float, ...]) -> None:
    """Look at what is shown, or as the request says: the same way in all pictures of a film."""
    direction, half_height = given["direction"], float(given["half_height"])
    focus = given["focus"] if half_height > 0.0 else np.zeros(3)
    plotter.camera_position = [tuple(focus + direction), tuple(focus), (0.0, 0.0, 1.0)]
    plotter.reset_camera(bounds=shown)
    if half_height > 0.0:
        away = np.array(plotter.camera.position) - plotter.camera.focal_point
        plotter.camera.focal_point = tuple(focus)
        plotter.camera.position = tuple(focus + away)
        plotter.camera.parallel_scale = half_height
        plotter.renderer.ResetCameraClippingRange()
    else:
        plotter.camera.zoom(ZOOM)


def surface_of(
    positions: NDArray[np.float64],
    spacing: float,
    reach: float,
    outline: float,
    domain: NDArray[np.float64],
    most_along: float,
) -> Any:
    """The surface of the body: grown by the `reach` of its points, then shrunk back to their `outline` [m].

    So gaps between points that stretching drew apart close, and the surface stays where it is. It is found on a lattice
    of `most_along` points along the longest edge at most.
    """
    lowest, highest = positions.min(axis=0), positions.max(axis=0)
    edge = max(spacing / FINENESS, float((highest - lowest).max()) / most_along)
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


def floor_of(corners: NDArray[np.float64], domain: NDArray[np.float64], spacing: float, margin: float) -> Any:
    """The part of the domain's floor on which points between two corners stand; None where they are above it.

    `margin` is that of the floor around the points, in their extent.
    """
    lowest, highest = corners
    if lowest[2] - domain[0, 2] > 2.0 * spacing:
        return None
    margin *= float((highest - lowest)[:2].max())
    lower, upper = np.maximum(lowest - margin, domain[0])[:2], np.minimum(highest + margin, domain[1])[:2]
    around = [(lower[0], lower[1]), (upper[0], lower[1]), (upper[0], upper[1]), (lower[0], upper[1])]
    return pyvista.PolyData(np.array([(*corner, domain[0, 2]) for corner in around]), faces=[4, 0, 1, 2, 3])


if __name__ == "__main__":
    for one in sorted(Path(sys.argv[1]).glob("*.npz")):
        render(one)
