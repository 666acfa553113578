"""`[[obstacle]]`: rigid bodies that stand in the way, and how they move."""

import warnings
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, model_validator

from grainlaw.mpm_core.scene.obstacle_shapes import OBSTACLE_SHAPES, AnyObstacleShape, Plane
from grainlaw.mpm_core.scene.section import (
    LARGEST_DENSITY,
    LARGEST_SPEED,
    Section,
    Vector,
    number_or_three,
    refuse_beyond,
)
from grainlaw.mpm_core.scene.terrain import Terrain
from grainlaw.mpm_core.space import Space

LARGEST_SPIN = 1e6  # 1/s


AngularVelocity = Annotated[
    float | tuple[float, float, float], number_or_three("angular velocity", LARGEST_SPIN, "1/s")
]


class MotionSection(Section):
    """A motion as a table, or a CSV file with the columns t, x, y (and z in 3D) and, where it turns, angle."""

    file: Path | None = Field(
        default=None, strict=False, description="CSV file; a relative path counts from the scene file"
    )
    time: list[float] | None = Field(default=None, min_length=2, description="increasing times from 0 on [s]")
    displacement: list[Vector] | None = Field(
        default=None, min_length=2, description="from the start, at each time [m]"
    )
    angle: list[float] | None = Field(
        default=None,
        min_length=2,
        description="turned since the start about the middle, by time [rad]; not in 3D",
    )

    @model_validator(mode="after")
    def _is_complete(self) -> "MotionSection":
        if self.file is not None:
            self._read(self.file)
        if self.time is None or self.displacement is None:
            raise ValueError("a motion needs a file, or time and displacement")
        for name in ("displacement", "angle"):
            values = getattr(self, name)
            if values is not None and len(values) != len(self.time):
                raise ValueError(f"{name} has {len(values)} entries, time has {len(self.time)}")
        if self.time[0] != 0.0 or any(later <= time for time, later in pairwise(self.time)):
            raise ValueError("time must begin at 0 and increase from value to value")
        ways = np.linalg.norm(np.diff(np.array(self.displacement, np.float64), axis=0), axis=1)
        fastest = int(np.argmax(ways / np.diff(self.time)))
        speed = ways[fastest] / (self.time[fastest + 1] - self.time[fastest])
        if not speed <= LARGEST_SPEED:
            raise ValueError(
                f"{speed:g} m/s from t = {self.time[fastest]:g} to {self.time[fastest + 1]:g} s is out of bounds; "
                f"allowed: up to {LARGEST_SPEED:g} m/s"
            )
        return self

    def _read(self, file: Path) -> None:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                table: Any = np.genfromtxt(file, delimiter=",", names=True, dtype=np.float64, encoding="utf-8-sig")
        except (OSError, ValueError, UserWarning) as error:
            raise ValueError(f"file {file} cannot be read: {error}") from error
        names = table.dtype.names or ()
        axes = [axis for axis in ("x", "y", "z") if axis in names]
        if "t" not in names or axes[:2] != ["x", "y"] or table.ndim != 1 or len(table) < 2:
            raise ValueError(f"file {file} needs two rows or more with the columns t, x, y (and z in 3D)")
        for row, values in enumerate(table, start=2):
            if not all(np.isfinite(value) for value in values.tolist()):
                raise ValueError(f"file {file}, line {row}: a value is missing or is no number")
        self.time = table["t"].tolist()
        self.displacement = [tuple(row) for row in np.column_stack([table[axis] for axis in axes]).tolist()]
        self.angle = table["angle"].tolist() if "angle" in names else None


class FreeSection(Section):
    """A motion that follows from gravity and contact."""

    density: float | None = Field(default=None, gt=0, le=LARGEST_DENSITY, description="of the obstacle [kg/m3]")
    mass: float | None = Field(
        default=None, gt=0, description="instead of a density; per width or per radian as the space has it [kg]"
    )
    velocity: Vector | None = Field(default=None, description="at the start [m/s]; default: at rest")
    angular_velocity: AngularVelocity = Field(default=0.0, description="at the start [1/s]; in 3D three components")
    turns: bool = Field(default=True, description="whether it can turn; never in axisymmetry")

    @model_validator(mode="after")
    def _has_one_mass(self) -> "FreeSection":
        if (self.density is None) == (self.mass is None):
            raise ValueError("free needs a density or a mass, and not both")
        return self


class ObstacleSection(Section):
    """A rigid obstacle: fixed, moved or free."""

    name: str = Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", description="name in tables, files and messages")
    shape: AnyObstacleShape = Field(
        description="rectangle, disc, polygon, line, terrain, plane; in 3D box, cylinder, sphere, plane, terrain, mesh"
    )
    friction: float = Field(ge=0, description="Coulomb friction coefficient of its surface [1]")
    hollow: bool = Field(default=False, description="the obstacle is around the shape: a container")
    velocity: Vector | None = Field(default=None, description="constant velocity [m/s]")
    angular_velocity: AngularVelocity = Field(
        default=0.0, description="constant angular velocity about `center` [1/s]; in 3D three components"
    )
    center: Vector | None = Field(
        default=None, description="centre of the turning, which moves with `velocity` [m]; default: the shape's middle"
    )
    motion: MotionSection | None = Field(default=None, description="displacements and angles over time")
    free: FreeSection | None = Field(default=None, description="moved by gravity and what touches it")
    until: float | None = Field(default=None, gt=0, description="when it is taken away [s]; default: it stays")

    @model_validator(mode="after")
    def _moves_in_one_way(self) -> "ObstacleSection":
        ways = [self.velocity is not None or self.is_turning, self.motion is not None, self.free is not None]
        if sum(ways) > 1:
            raise ValueError("velocity and angular_velocity, motion, and free exclude one another")
        if self.center is not None and not self.is_turning:
            raise ValueError("a center belongs to an angular_velocity")
        if isinstance(self.shape, Plane | Terrain) and (self.free is not None or self.hollow):
            raise ValueError(f"a {self.shape.kind} is neither free nor hollow")
        for velocity in (self.velocity, self.free.velocity if self.free else None):
            if velocity is not None:
                refuse_beyond(velocity, LARGEST_SPEED, "m/s")
        return self

    @property
    def is_turning(self) -> bool:
        """Whether a constant angular velocity is given."""
        spin = self.angular_velocity
        return any(spin) if isinstance(spin, tuple) else spin != 0.0

    def refuse_for(self, key: str, space: Space) -> None:
        """Raises ValueError for a shape or a motion that the space does not have."""
        if self.shape.kind not in OBSTACLE_SHAPES[space.axes]:
            known = ", ".join(OBSTACLE_SHAPES[space.axes])
            raise ValueError(f"{key}.shape.kind = '{self.shape.kind}': allowed in space = '{space.name}': {known}")
        self._refuse_components(key, space)
        if isinstance(self.shape, Terrain):
            self._read_terrain(self.shape, key, space)
        if space.hoop:
            moved = [self.velocity, self.free.velocity if self.free else None]
            moved += self.motion.displacement or [] if self.motion else []
            if any(vector is not None and vector[0] != 0.0 for vector in moved):
                raise ValueError(f"{key}: in space = 'axisymmetric' obstacles move along the axis only; allowed: x = 0")
            if self.is_turning or (self.motion is not None and self.motion.angle is not None):
                raise ValueError(f"{key}: in space = 'axisymmetric' no obstacle turns in the r-y plane")

    def _read_terrain(self, terrain: Terrain, key: str, space: Space) -> None:
        try:
            terrain.read_for(space.axes)
        except ValueError as error:
            raise ValueError(f"{key}.shape: {error}") from error
        moves = self.velocity is not None or self.is_turning or self.motion is not None
        if space.axes == 3 and moves:
            raise ValueError(f"{key}: terrain in 3D rests; allowed: no velocity, angular_velocity or motion")

    def _refuse_components(self, key: str, space: Space) -> None:
        vectors = {"velocity": self.velocity, "center": self.center}
        if self.free is not None:
            vectors["free.velocity"] = self.free.velocity
        if isinstance(self.shape, Plane):
            vectors |= {"shape.point": self.shape.point, "shape.normal": self.shape.normal}
        if self.motion is not None and self.motion.displacement is not None:
            vectors |= {f"motion.displacement.{row}": value for row, value in enumerate(self.motion.displacement)}
        for name, vector in vectors.items():
            if vector is not None and len(vector) != space.axes:
                names = ", ".join(space.axis_names)
                raise ValueError(f"{key}.{name} = {list(vector)}: space = '{space.name}' takes {names}")
        for name, spin in (
            ("angular_velocity", self.angular_velocity),
            ("free.angular_velocity", self.free.angular_velocity if self.free else 0.0),
        ):
            if spin and isinstance(spin, tuple) != (space.axes == 3):
                takes = "three components" if space.axes == 3 else "a number"
                raise ValueError(f"{key}.{name}: space = '{space.name}' takes {takes}")
        if space.axes == 3 and self.motion is not None and self.motion.angle is not None:
            raise ValueError(f"{key}.motion.angle: in space = '3d' an angle has no axis; allowed: displacement")
