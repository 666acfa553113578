"""Shapes of bodies in three dimensions."""

import math
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from grainlaw.mpm_core.scene.outline import Points, off_edges
from grainlaw.mpm_core.scene.shape import Shape

Place = Annotated[tuple[float, float, float], Field(strict=False)]


class Box(Shape):
    """An axis-aligned box."""

    kind: Literal["box"]
    lower: Place = Field(description="lower left front corner [m]")
    upper: Place = Field(description="upper right back corner [m]")

    @model_validator(mode="after")
    def _has_volume(self) -> "Box":
        if not all(high > low for low, high in zip(self.lower, self.upper, strict=True)):
            raise ValueError(f"upper = {list(self.upper)} must lie above lower = {list(self.lower)} along x, y and z")
        return self

    def bounds(self) -> tuple[Place, Place]:
        """The box itself."""
        return self.lower, self.upper

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Inside or on the lower, left and front faces."""
        shifted = off_edges(points)
        return np.asarray(((shifted >= np.array(self.lower)) & (shifted < np.array(self.upper))).all(axis=1))


class Sphere(Shape):
    """A sphere."""

    kind: Literal["sphere"]
    center: Place = Field(description="centre [m]")
    radius: float = Field(gt=0, description="radius [m]")

    def bounds(self) -> tuple[Place, Place]:
        """The cube around the sphere."""
        x, y, z = self.center
        r = self.radius
        return (x - r, y - r, z - r), (x + r, y + r, z + r)

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Closer to the centre than the radius."""
        return np.asarray(np.linalg.norm(points - np.array(self.center), axis=1) < self.radius)


class Round(Shape):
    """What turns about an axis from the centre of its base."""

    center: Place = Field(description="centre of the base [m]")
    radius: float = Field(gt=0, description="radius of the base [m]")
    height: float = Field(gt=0, description="height along the axis [m]")
    axis: Place = Field(default=(0.0, 0.0, 1.0), description="direction from the base to the other end, of any length")

    @model_validator(mode="after")
    def _axis_has_a_direction(self) -> "Round":
        if not 0.0 < math.hypot(*self.axis) < math.inf:
            raise ValueError(f"axis = {list(self.axis)} has no direction; allowed: any vector but zero")
        return self

    @property
    def direction(self) -> NDArray[np.float64]:
        """The unit vector along the axis."""
        return np.array(self.axis) / math.hypot(*self.axis)

    def bounds(self) -> tuple[Place, Place]:
        """The box around both ends."""
        # A disc of radius r with normal a reaches r sqrt(1 - a_i^2) along axis i.
        reach = np.sqrt(np.maximum(1.0 - self.direction**2, 0.0))
        base = np.array(self.center)
        end = base + self.height * self.direction
        lower = np.minimum(base - self.radius * reach, end - self.end_radius * reach)
        upper = np.maximum(base + self.radius * reach, end + self.end_radius * reach)
        return tuple(lower.tolist()), tuple(upper.tolist())

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Between base and end, closer to the axis than the radius there."""
        along = (off_edges(points) - np.array(self.center)) @ self.direction
        across = np.linalg.norm(np.cross(points - np.array(self.center), self.direction), axis=1)
        radius = self.radius + (self.end_radius - self.radius) * along / self.height
        return np.asarray((along >= 0.0) & (along < self.height) & (across < radius))

    @property
    def end_radius(self) -> float:
        """The radius at the other end of the axis [m]."""
        raise NotImplementedError


class Cylinder(Round):
    """A circular cylinder."""

    kind: Literal["cylinder"]

    @property
    def end_radius(self) -> float:
        """That of the base [m]."""
        return self.radius


class Cone(Round):
    """A circular cone or, with `upper_radius`, the frustum of one."""

    kind: Literal["cone"]
    upper_radius: float = Field(default=0.0, ge=0, description="radius at the other end; 0: a tip [m]")

    @property
    def end_radius(self) -> float:
        """That at the other end [m]."""
        return self.upper_radius
