"""Shapes of bodies in the plane, all shapes by kind, and the regular lattice of points that fills one."""

import math
from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from grainlaw.mpm_core.scene.mesh_region import MeshRegion
from grainlaw.mpm_core.scene.outline import Points, closed_edges, enclosed, off_edges, outer_edges
from grainlaw.mpm_core.scene.shape import Shape
from grainlaw.mpm_core.scene.solids import Box, Cone, Cylinder, Sphere

# While a shape is filled, in the memory of some hundred bytes each.
CANDIDATES_AT_ONCE = 2**18

Corner = Annotated[tuple[float, float], Field(strict=False)]


class Rectangle(Shape):
    """An axis-aligned rectangle."""

    kind: Literal["rectangle"]
    lower: Corner = Field(description="lower left corner [m]")
    upper: Corner = Field(description="upper right corner [m]")

    @model_validator(mode="after")
    def _has_area(self) -> "Rectangle":
        if not (self.upper[0] > self.lower[0] and self.upper[1] > self.lower[1]):
            raise ValueError(
                f"upper = {list(self.upper)} must lie above and to the right of lower = {list(self.lower)}"
            )
        return self

    def bounds(self) -> tuple[Corner, Corner]:
        """The rectangle itself."""
        return self.lower, self.upper

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Inside or on the lower and left edges."""
        shifted = off_edges(points)
        inside = (shifted >= np.array(self.lower)) & (shifted < np.array(self.upper))
        return np.asarray(inside.all(axis=1))


class Disc(Shape):
    """A disc."""

    kind: Literal["disc"]
    center: Corner = Field(description="centre [m]")
    radius: float = Field(gt=0, description="radius [m]")

    def bounds(self) -> tuple[Corner, Corner]:
        """The square around the disc."""
        (x, y), r = self.center, self.radius
        return (x - r, y - r), (x + r, y + r)

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Closer to the centre than the radius."""
        return np.hypot(points[:, 0] - self.center[0], points[:, 1] - self.center[1]) < self.radius


class Polygon(Shape):
    """A simple polygon, its corners in either order."""

    kind: Literal["polygon"]
    vertices: list[Corner] = Field(min_length=3, description="corners in order [m]")

    @model_validator(mode="after")
    def _is_simple(self) -> "Polygon":
        from shapely import Polygon as Ring
        from shapely import is_valid, is_valid_reason

        ring = Ring(self.vertices)
        if not is_valid(ring):
            what, _, place = is_valid_reason(ring).partition("[")
            if "intersection" in what.lower():
                raise ValueError(f"the polygon crosses or touches itself at ({', '.join(place.strip(']').split())})")
        if not ring.area > 0:
            raise ValueError("the polygon has no area")
        return self

    def bounds(self) -> tuple[Corner, Corner]:
        """The box around the corners."""
        corners = np.array(self.vertices)
        return tuple(corners.min(axis=0)), tuple(corners.max(axis=0))

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Inside or on the lower and left edges."""
        return enclosed(points, outer_edges(closed_edges(np.array([self.vertices]))))


AnyShape = Annotated[
    Rectangle | Disc | Polygon | MeshRegion | Box | Cylinder | Cone | Sphere, Field(discriminator="kind")
]
# The shapes of the spaces with two axes and with three, by kind.
SHAPES: dict[int, dict[str, type[Shape]]] = {
    2: {"rectangle": Rectangle, "disc": Disc, "polygon": Polygon, "mesh": MeshRegion},
    3: {"box": Box, "cylinder": Cylinder, "cone": Cone, "sphere": Sphere, "mesh": MeshRegion},
}


def refused_mesh(shape: AnyShape) -> str:
    """What is wrong with a shape that has not as many axes as its space; only that of a mesh file can be."""
    file = shape.file if isinstance(shape, MeshRegion) else ""
    if len(shape.bounds()[0]) == 2:
        return f"mesh file {file} lies in the x-y plane; allowed: a closed surface or tetrahedra"
    return f"mesh file {file} has a volume; allowed: triangles and quadrilaterals in the x-y plane"


def points_along_edge(points_per_cell: int, axes: int) -> int:
    """How many of the points of a cell stand in a row along one of its edges."""
    return round(points_per_cell ** (1.0 / axes))


def lattice(
    shape: Shape,
    origin: tuple[float, ...],
    cell_size: float,
    points_per_cell: int,
    shift: Sequence[float] = (),
    domain: tuple[Sequence[float], Sequence[float]] | None = None,
) -> Points:
    """Points at the centres of the parts of the grid's cells whose centre lies in the shape, shape (n, axes) [m].

    Cells are divided into equal squares, or cubes. Points are ordered by columns along the last axis, upwards. All are
    moved by a `shift`, in distances of neighbours; then none lies outside of a `domain`, given by its corners [m].
    """
    spacing = cell_size / points_along_edge(points_per_cell, len(origin))
    way = spacing * np.array(shift or (0.0,) * len(origin))
    axes: list[NDArray[Any]] = []
    for axis, (start, lower, upper) in enumerate(zip(origin, *shape.bounds(), strict=True)):
        first = int(np.floor((lower - start) / spacing + 1e-6))
        last = int(np.ceil((upper - start) / spacing - 1e-6))
        places = start + (np.arange(first, last) + 0.5) * spacing
        if domain is not None:
            moved = places + way[axis]
            places = places[(moved > domain[0][axis]) & (moved < domain[1][axis])]
        axes.append(places)
    # In layers, so that a large shape needs little more memory than its points.
    layers = max(1, CANDIDATES_AT_ONCE // max(1, math.prod(len(places) for places in axes[1:])))
    parts = [_inside(shape, axes[0][at : at + layers], *axes[1:]) for at in range(0, len(axes[0]), layers)]
    points = np.concatenate([np.empty((0, len(origin))), *parts])
    return points + way if shift else points


def _inside(shape: Shape, *axes: NDArray[Any]) -> Points:
    """Those points of all combinations of places along axes [m] that lie in a shape."""
    candidates = np.column_stack([places.ravel() for places in np.meshgrid(*axes, indexing="ij")])
    return candidates[shape.contains(candidates)]
