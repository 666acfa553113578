"""`[[inflow]]`: mouths through which material enters at a speed."""

import math
from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from grainlaw.mpm_core.scene.section import (
    LARGEST_DENSITY,
    LARGEST_PRESSURE,
    LARGEST_SPEED,
    Section,
    Vector,
    refuse_beyond,
)
from grainlaw.mpm_core.scene.shapes import Corner
from grainlaw.mpm_core.scene.solids import Place
from grainlaw.mpm_core.space import Space

Floats = NDArray[np.float64]

# Of the speed, at least across the mouth.
LEAST_ACROSS = 0.1


class Layer(NamedTuple):
    """The lattice of a mouth.

    centers  of the parts of the mouth that a point stands for, shape (n, axes) [m]
    areas    of these parts [m2], in two axes their widths [m], shape (n,)
    across   unit vectors in the mouth, shape (axes - 1, axes)
    spacing  of the lattice along each of them [m], shape (axes - 1,)
    normal   of the mouth, the way the material goes, shape (axes,)
    """

    centers: Floats
    areas: Floats
    across: Floats
    spacing: Floats
    normal: Floats


class Strip(Section):
    """A straight mouth in two axes; in axisymmetry a ring, or a disc from the axis on."""

    kind: Literal["strip"]
    ends: Annotated[tuple[Corner, Corner], Field(strict=False)] = Field(description="both ends [m]")

    @model_validator(mode="after")
    def _has_length(self) -> "Strip":
        if self.ends[0] == self.ends[1]:
            raise ValueError(f"ends: both are {list(self.ends[0])}; allowed: two places")
        return self

    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The box around it."""
        ends = np.array(self.ends)
        return tuple(ends.min(axis=0).tolist()), tuple(ends.max(axis=0).tolist())

    def layer(self, spacing: float, velocity: Floats) -> Layer:
        """Equal parts about as wide as a spacing [m]."""
        first, last = np.array(self.ends)
        length = float(np.linalg.norm(last - first))
        along, count = (last - first) / length, round(length / spacing)
        width = length / max(count, 1)
        centers = first + width * (np.arange(count) + 0.5)[:, np.newaxis] * along
        normal = np.array([along[1], -along[0]])
        return _layer(centers, width, along[np.newaxis], [width], normal, velocity)


class Opening(Section):
    """A rectangular mouth in 3D, across an axis."""

    kind: Literal["rectangle"]
    lower: Place = Field(description="lower corner [m]")
    upper: Place = Field(description="upper corner, with one coordinate the same [m]")

    @model_validator(mode="after")
    def _is_flat(self) -> "Opening":
        extents = [high - low for low, high in zip(self.lower, self.upper, strict=True)]
        if sorted(extent > 0.0 for extent in extents) != [False, True, True] or min(extents) < 0.0:
            raise ValueError(
                f"upper = {list(self.upper)} must have one coordinate of lower = {list(self.lower)} and lie above it "
                "along the two others"
            )
        return self

    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The rectangle itself."""
        return self.lower, self.upper

    def layer(self, spacing: float, velocity: Floats) -> Layer:
        """Equal parts about as large as a spacing [m] along both edges."""
        extents = np.array(self.upper) - np.array(self.lower)
        flat = int(np.argmin(extents))
        edges = [axis for axis in range(3) if axis != flat]
        counts = [round(extents[axis] / spacing) for axis in edges]
        widths = [float(extents[axis]) / max(count, 1) for axis, count in zip(edges, counts, strict=True)]
        places = [width * (np.arange(count) + 0.5) for width, count in zip(widths, counts, strict=True)]
        in_mouth = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1).reshape(-1, 2)
        across = np.eye(3)[edges]
        return _layer(
            np.array(self.lower) + in_mouth @ across, math.prod(widths), across, widths, np.eye(3)[flat], velocity
        )


class RoundMouth(Section):
    """A round mouth in 3D, across the velocity."""

    kind: Literal["disc"]
    center: Place = Field(description="centre [m]")
    radius: float = Field(gt=0, description="radius [m]")

    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The cube around it."""
        center = np.array(self.center)
        return tuple((center - self.radius).tolist()), tuple((center + self.radius).tolist())

    def layer(self, spacing: float, velocity: Floats) -> Layer:
        """A square lattice, whose spacing [m] is changed a little for its squares to have the area of the disc."""
        normal = velocity / np.linalg.norm(velocity)
        beside = np.eye(3)[int(np.argmin(np.abs(normal)))]
        first = np.cross(normal, beside) / np.linalg.norm(np.cross(normal, beside))
        across = np.array([first, np.cross(normal, first)])
        reach = math.ceil(self.radius / spacing)
        places = spacing * (np.arange(-reach, reach) + 0.5)
        in_mouth = np.stack(np.meshgrid(places, places, indexing="ij"), axis=-1).reshape(-1, 2)
        in_mouth = in_mouth[np.hypot(*in_mouth.T) < self.radius]
        area = math.pi * self.radius**2 / max(len(in_mouth), 1)
        in_mouth *= math.sqrt(area) / spacing
        return _layer(np.array(self.center) + in_mouth @ across, area, across, [math.sqrt(area)] * 2, normal, velocity)


def _layer(
    centers: Floats, area: float, across: Floats, spacing: list[float], normal: Floats, velocity: Floats
) -> Layer:
    way = 1.0 if velocity @ normal > 0.0 else -1.0
    return Layer(centers, np.full(len(centers), area), across, np.array(spacing), way * normal)


AnyMouth = Annotated[Strip | Opening | RoundMouth, Field(discriminator="kind")]
# The mouths of the spaces with two axes and with three, by kind.
MOUTHS: dict[int, tuple[str, ...]] = {2: ("strip",), 3: ("rectangle", "disc")}


class InflowSection(Section):
    """A mouth through which material enters at a speed, at the rate density times area times speed across it."""

    name: str = Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", description="name in messages")
    material: str = Field(description="name of a [material.NAME] table")
    shape: AnyMouth = Field(description="strip; in 3D rectangle or disc")
    velocity: Vector = Field(description="with which material enters [m/s]; in axisymmetry along the axis")
    density: float = Field(gt=0, le=LARGEST_DENSITY, description="bulk density of what enters [kg/m3]")
    pressure: float = Field(
        default=0.0,
        ge=0,
        le=LARGEST_PRESSURE,
        description="with which it enters, for a law whose stiffness grows with pressure [Pa]",
    )
    points_per_cell: Literal[1, 4, 8, 9, 16, 25, 27, 36, 64] = Field(
        default=4, description="material points per cell, a square number; in 3D a cube number, default: 8"
    )
    start: float = Field(default=0.0, ge=0, description="when it begins [s]")
    until: float | None = Field(default=None, gt=0, description="when it ends [s]; default: it does not")

    @model_validator(mode="after")
    def _flows(self) -> "InflowSection":
        refuse_beyond(self.velocity, LARGEST_SPEED, "m/s")
        if not any(self.velocity):
            raise ValueError("velocity is zero; allowed: any vector but zero")
        if self.until is not None and self.until <= self.start:
            raise ValueError(f"until = {self.until:g} s is not after start = {self.start:g} s")
        return self

    def refuse_for(self, key: str, space: Space) -> None:
        """Raises ValueError for a mouth or a velocity that the space does not have, and for one along the mouth."""
        if self.shape.kind not in MOUTHS[space.axes]:
            known = ", ".join(MOUTHS[space.axes])
            raise ValueError(f"{key}.shape.kind = '{self.shape.kind}': allowed in space = '{space.name}': {known}")
        velocity = np.array(self.velocity)
        if space.hoop and velocity[0] != 0.0:
            raise ValueError(
                f"{key}.velocity = {list(self.velocity)}: in space = 'axisymmetric' material enters along the axis; "
                "allowed: x = 0"
            )
        normal = self.shape.layer(1.0, velocity).normal
        if float(velocity @ normal) < LEAST_ACROSS * float(np.linalg.norm(velocity)):
            raise ValueError(f"{key}.velocity = {list(self.velocity)} goes along the mouth; allowed: through it")
