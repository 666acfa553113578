"""Shapes of obstacles, and those that only they have: lines with a thickness, planes."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from grainlaw.mpm_core.scene.mesh_region import MeshRegion
from grainlaw.mpm_core.scene.outline import Points
from grainlaw.mpm_core.scene.section import Section
from grainlaw.mpm_core.scene.shapes import Corner, Disc, Polygon, Rectangle
from grainlaw.mpm_core.scene.solids import Box, Cylinder, Sphere
from grainlaw.mpm_core.scene.terrain import Terrain


class Line(Section):
    """A plate along a line of points, of some thickness to both sides together."""

    kind: Literal["line"]
    points: list[Corner] = Field(min_length=2, description="points in order [m]")
    thickness: float = Field(gt=0, description="thickness, half to either side [m]")

    @model_validator(mode="after")
    def _is_simple(self) -> "Line":
        from shapely import LineString

        if not LineString(self.points).is_simple:
            raise ValueError("the line crosses itself")
        if len(self.outline()) < 3:
            raise ValueError("the line has no length")
        return self

    def outline(self) -> Points:
        """The corners of the plate, shape (n, 2) [m]."""
        from shapely import LineString
        from shapely.geometry import CAP_STYLE, JOIN_STYLE

        around = LineString(self.points).buffer(
            0.5 * self.thickness, cap_style=CAP_STYLE.flat, join_style=JOIN_STYLE.mitre
        )
        if around.is_empty or len(around.interiors) > 0:
            raise ValueError("the plate along the line closes on itself; make it of two lines, or thinner")
        return np.array(around.exterior.coords)[:-1]


class Plane(Section):
    """Everything behind a plane, in two axes behind a line."""

    kind: Literal["plane"]
    point: Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=3)] = Field(
        description="a point of the plane [m]"
    )
    normal: Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=3)] = Field(
        description="direction out of the obstacle, of any length"
    )

    @model_validator(mode="after")
    def _has_a_direction(self) -> "Plane":
        if len(self.point) != len(self.normal):
            raise ValueError(f"normal = {list(self.normal)} has not as many components as point = {list(self.point)}")
        if not 0.0 < math.hypot(*self.normal) < math.inf:
            raise ValueError(f"normal = {list(self.normal)} has no direction; allowed: any vector but zero")
        return self


AnyObstacleShape = Annotated[
    Rectangle | Disc | Polygon | Line | Terrain | Plane | Box | Cylinder | Sphere | MeshRegion,
    Field(discriminator="kind"),
]
# The shapes of obstacles in the spaces with two axes and with three, by kind.
OBSTACLE_SHAPES: dict[int, tuple[str, ...]] = {
    2: ("rectangle", "disc", "polygon", "line", "terrain", "plane"),
    3: ("box", "cylinder", "sphere", "plane", "terrain", "mesh"),
}
