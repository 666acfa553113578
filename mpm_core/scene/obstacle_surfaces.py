"""The surface of an obstacle's shape: where its frame stands, and its distances in that frame."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.mpm_core.obstacles import surface as surfaces
from grainlaw.mpm_core.obstacles.motion import in_3d, turn_about
from grainlaw.mpm_core.obstacles.surface import Surface, SurfaceKind
from grainlaw.mpm_core.scene.heights import Heights
from grainlaw.mpm_core.scene.mesh_region import MeshRegion
from grainlaw.mpm_core.scene.model import GridSection
from grainlaw.mpm_core.scene.obstacle_shapes import AnyObstacleShape, Line, Plane
from grainlaw.mpm_core.scene.shapes import Disc, Polygon, Rectangle
from grainlaw.mpm_core.scene.solids import Box, Cylinder, Sphere
from grainlaw.mpm_core.scene.terrain import Terrain
from grainlaw.mpm_core.scene.terrain_distances import distances_of_terrain

Floats = NDArray[np.float64]

# Distances on the grid of a mesh, at most, and cells that it reaches beyond the mesh.
MOST_DISTANCES, MARGIN = 8e6, 2.0
# Places at which a mesh is looked at for parts that overlap.
MOST_LOOKED_AT = 5e5


class Placed(NamedTuple):
    """A surface in its frame, the frame's position [m] (its centre of mass) and rotation, and what it measures.

    volume   [m3], in two axes its area [m2]
    inertia  about the frame's axes over the density, shape (3,); in two axes only the third counts
    """

    surface: Surface
    position: Floats
    rotation: Floats
    volume: float
    inertia: Floats

    @property
    def volume_per_radian(self) -> float:
        """What the part at r > 0 of a section sweeps around the axis in a radian [m3]: the integral of r over it."""
        if self.surface.kind == SurfaceKind.BALL:
            return _swept_by_disc(float(self.position[0]), float(self.surface.numbers[0]))
        if self.surface.kind != SurfaceKind.POLYGON:
            return np.inf
        return _swept_by_polygon(self.surface.numbers.reshape(-1, 2) + self.position[:2])


def placed(shape: AnyObstacleShape, grid: GridSection) -> Placed:
    """The surface of a shape. Raises ValueError where a mesh has none that can be used."""
    if isinstance(shape, Terrain):
        return _terrain_in_3d(shape.heights, grid) if len(grid.lower) == 3 else _terrain(shape, grid)
    if isinstance(shape, MeshRegion):
        return _mesh(shape, grid)
    return _OF_SHAPES[type(shape)](shape)


def _mesh(shape: MeshRegion, grid: GridSection) -> Placed:
    """Distances of a closed surface of triangles, on a grid of half the size of a cell, or coarser for a large one.

    The frame stands in the centre of mass; inertia counts about the axes of space through it (Eberly 2002, Polyhedral
    Mass Properties, by the divergence theorem for each triangle).
    """
    if len(shape.bounds()[0]) != 3:
        raise ValueError(f"mesh file {shape.file} lies in the x-y plane; allowed: a closed surface or tetrahedra")
    lower, upper = map(np.array, shape.bounds())
    _refuse_overlaps(shape, max(grid.cell_size, float((np.prod(upper - lower) / MOST_LOOKED_AT) ** (1.0 / 3.0))))
    volume, center, inertia = _mass_properties(shape.triangles())
    spacing = max(0.5 * grid.cell_size, float((np.prod(upper - lower) / MOST_DISTANCES) ** (1.0 / 3.0)))
    # as far around it as a point reaches
    start = lower - center - MARGIN * grid.cell_size
    counts = np.ceil((upper - lower + 2.0 * MARGIN * grid.cell_size) / spacing).astype(int) + 1
    distances = _distances_of_triangles(shape.triangles() - center, start, spacing, counts, volume < 0.0)
    return _placed(surfaces.distance_grid(start.tolist(), spacing, distances), tuple(center), abs(volume), inertia)


def _refuse_overlaps(shape: MeshRegion, spacing: float) -> None:
    """Where parts overlap, distances within would be those to the faces inside, and volumes would count twice."""
    axes = [np.arange(low + 0.5 * spacing, high, spacing) for low, high in zip(*shape.bounds(), strict=True)]
    try:
        shape.contains(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3))
    except InputError as error:
        raise ValueError(str(error)) from error


def _distances_of_triangles(
    triangles: Floats, start: Floats, spacing: float, counts: NDArray[np.int64], is_inside_out: bool
) -> Floats:
    """Signed distances on a regular grid from triangles, shape (m, 3, 3); negative behind them, or before them."""
    import pyvista

    faces = np.column_stack([np.full(len(triangles), 3), np.arange(3 * len(triangles)).reshape(-1, 3)])
    surface = pyvista.PolyData(triangles.reshape(-1, 3), faces.ravel()).clean()
    image = pyvista.ImageData(dimensions=counts.tolist(), spacing=(spacing,) * 3, origin=start.tolist())
    found = image.compute_implicit_distance(surface)["implicit_distance"]
    distances = np.asarray(found, np.float64).reshape(counts[::-1]).transpose(2, 1, 0)
    return np.ascontiguousarray(-distances if is_inside_out else distances)


def _mass_properties(triangles: Floats) -> tuple[float, Floats, Floats]:
    """Volume [m3], negative if the triangles face inwards, centre of mass [m] and inertia over the density [m5]."""
    first, second, third = np.moveaxis(triangles, 1, 0)
    # of the tetrahedra between the origin and each triangle
    volumes = np.einsum("ij,ij->i", first, np.cross(second, third)) / 6.0
    volume = float(volumes.sum())
    sums = first + second + third
    center = np.asarray((volumes[:, np.newaxis] * sums).sum(axis=0) / (4.0 * volume))
    squares = (volumes[:, np.newaxis] * (sums**2 + first**2 + second**2 + third**2)).sum(axis=0) / 20.0
    squares = np.abs(squares) - abs(volume) * center**2
    return volume, center, squares.sum() - squares


def _placed(surface: Surface, center: tuple[float, ...], volume: float, inertia: float | Floats) -> Placed:
    return Placed(surface, in_3d(center), np.eye(3), volume, np.broadcast_to(inertia, 3).astype(np.float64))


def _polygon(corners: Floats) -> Placed:
    """Area, centroid and polar moment of a polygon are sums over its edges (Green's theorem)."""
    x, y = corners.T
    next_x, next_y = np.roll(x, -1), np.roll(y, -1)
    cross = x * next_y - next_x * y
    area = 0.5 * cross.sum()
    center = np.array([((x + next_x) * cross).sum(), ((y + next_y) * cross).sum()]) / (6.0 * area)
    squares = x * x + x * next_x + next_x * next_x + y * y + y * next_y + next_y * next_y
    polar = (cross * squares).sum() / 12.0 - area * float(center @ center)
    surface = surfaces.polygon(corners - center)
    return _placed(surface, tuple(center), abs(float(area)), abs(float(polar)))


def _swept_by_polygon(corners: Floats) -> float:
    import shapely

    (_, low), (right, high) = corners.min(axis=0), corners.max(axis=0)
    section = shapely.Polygon(corners).intersection(shapely.box(0.0, low, max(right, 0.0), high))
    return float(section.area * section.centroid.x) if section.area > 0.0 else 0.0


def _swept_by_disc(center: float, radius: float) -> float:
    """Of a disc of a radius [m] whose centre lies at r = `center` [m]."""
    beyond = min(max(center / radius, -1.0), 1.0)
    half_chord = radius * np.sqrt(1.0 - beyond**2)
    area = radius**2 * (np.pi - np.arccos(beyond)) + beyond * radius * half_chord
    return float(center * area + 2.0 / 3.0 * half_chord**3)


def _plane(shape: Plane) -> Placed:
    normal = np.array(shape.normal) / np.linalg.norm(shape.normal)
    if len(normal) == 2:
        rotation = np.array([[normal[1], normal[0], 0.0], [-normal[0], normal[1], 0.0], [0.0, 0.0, 1.0]])
    else:
        rotation = _turned_up(normal)
    return Placed(surfaces.half_space(), in_3d(shape.point), rotation, np.inf, np.full(3, np.inf))


def _turned_up(direction: Floats) -> Floats:
    """A rotation that takes the z axis to a unit vector."""
    up = np.array([0.0, 0.0, 1.0])
    axis, cosine = np.cross(up, direction), float(direction[2])
    if np.linalg.norm(axis) < 1e-12:
        return np.eye(3) if cosine > 0.0 else np.diag([1.0, -1.0, -1.0])
    angle = np.arctan2(np.linalg.norm(axis), cosine)
    return np.asarray(turn_about(angle * axis / np.linalg.norm(axis)).as_matrix())


def _box(shape: Box) -> Placed:
    half = 0.5 * (np.array(shape.upper) - np.array(shape.lower))
    center = 0.5 * (np.array(shape.upper) + np.array(shape.lower))
    volume = 8.0 * float(half.prod())
    inertia = volume / 3.0 * (half @ half - half**2)
    return _placed(surfaces.box(half.tolist()), tuple(center), volume, inertia)


def _cylinder(shape: Cylinder) -> Placed:
    radius, height = shape.radius, shape.height
    volume = np.pi * radius**2 * height
    across = volume * (radius**2 / 4.0 + height**2 / 12.0)
    center = np.array(shape.center) + 0.5 * height * shape.direction
    inertia = np.array([across, across, 0.5 * volume * radius**2])
    return Placed(surfaces.cylinder(radius, 0.5 * height), center, _turned_up(shape.direction), volume, inertia)


def _rectangle(shape: Rectangle) -> Placed:
    (left, bottom), (right, top) = shape.lower, shape.upper
    return _polygon(np.array([(left, bottom), (right, bottom), (right, top), (left, top)]))


def _terrain(shape: Terrain, grid: GridSection) -> Placed:
    # as far beyond the domain as it is wide and high: no other side is ever the nearest
    far = sum(high - low for low, high in zip(grid.lower, grid.upper, strict=True))
    lowest = min(grid.lower[1], *(y for _, y in shape.line))
    return _polygon(shape.outline(grid.lower[0] - far, grid.upper[0] + far, lowest - far))


def _terrain_in_3d(heights: Heights, grid: GridSection) -> Placed:
    """The ground below heights. Raises ValueError where they do not cover the domain."""
    start, spacing, distances = distances_of_terrain(heights, grid, MOST_DISTANCES)
    middle = start + 0.5 * spacing * (np.array(distances.shape) - 1)
    surface = surfaces.distance_grid((start - middle).tolist(), spacing, distances)
    return Placed(surface, middle, np.eye(3), np.inf, np.full(3, np.inf))


def _disc(shape: Disc) -> Placed:
    area = np.pi * shape.radius**2
    return _placed(surfaces.ball(shape.radius), shape.center, area, 0.5 * area * shape.radius**2)


def _sphere(shape: Sphere) -> Placed:
    volume = 4.0 / 3.0 * np.pi * shape.radius**3
    return _placed(surfaces.ball(shape.radius), shape.center, volume, 0.4 * volume * shape.radius**2)


_OF_SHAPES: dict[type[Any], Callable[[Any], Placed]] = {
    Rectangle: _rectangle,
    Polygon: lambda shape: _polygon(np.array(shape.vertices)),
    Line: lambda shape: _polygon(shape.outline()),
    Disc: _disc,
    Plane: _plane,
    Sphere: _sphere,
    Box: _box,
    Cylinder: _cylinder,
}
