"""The tables of a body: its shape, its material, and its state at the start."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from grainlaw.mpm_core.scene.section import (
    LARGEST_DENSITY,
    LARGEST_PRESSURE,
    LARGEST_RATIO,
    LARGEST_SPEED,
    Section,
    Vector,
    refuse_beyond,
)
from grainlaw.mpm_core.scene.shapes import AnyShape


class InitialStressSection(Section):
    """The stress of a body at the start."""

    kind: Literal["none", "uniform", "geostatic", "table"] = Field(
        default="none",
        description="no stress, a uniform pressure, the weight of the material above, of all bodies, or a table over "
        "depth",
    )
    pressure: float = Field(default=0.0, ge=0, le=LARGEST_PRESSURE, description="pressure of kind = 'uniform' [Pa]")
    horizontal_ratio: float = Field(
        default=1.0,
        ge=0,
        le=LARGEST_RATIO,
        description="horizontal over vertical stress, unless the stress is uniform: sigma_xx/sigma_yy in plane strain, "
        "in axisymmetry also around the axis, in 3D sigma_xx and sigma_yy over sigma_zz [1]",
    )
    out_of_plane_ratio: float | None = Field(
        default=0.5,
        ge=0,
        le=LARGEST_RATIO,
        description="sigma_zz/(sigma_xx + sigma_yy) in plane strain, and in no other space, unless the stress is "
        "uniform; 0.5 with ratio 1: isotropic [1]",
    )
    surcharge: float = Field(
        default=0.0,
        ge=0,
        le=LARGEST_PRESSURE,
        description="load on the body where nothing covers it, for kind = 'geostatic'; what lies below carries it, "
        "too [Pa]",
    )

    depth: list[float] | None = Field(
        default=None, min_length=2, description="increasing depths of kind = 'table', below the free top [m]"
    )
    vertical_stress: list[float] | None = Field(
        default=None,
        min_length=2,
        description="vertical stress at each `depth`, compression positive; linear between them [Pa]",
    )

    @model_validator(mode="after")
    def _table_is_complete(self) -> "InitialStressSection":
        if self.kind != "table":
            if self.depth is not None or self.vertical_stress is not None:
                raise ValueError("depth and vertical_stress belong to kind = 'table', and to no other")
            return self
        if self.depth is None or self.vertical_stress is None or len(self.depth) != len(self.vertical_stress):
            raise ValueError("kind = 'table' needs depth and vertical_stress, lists of one length")
        if any(second <= first for first, second in pairwise(self.depth)):
            raise ValueError("depth must increase from value to value")
        for stress in self.vertical_stress:
            if not 0 <= stress <= LARGEST_PRESSURE:
                allowed = f"0 to {LARGEST_PRESSURE:g} Pa (compression is positive)"
                raise ValueError(f"vertical_stress holds {stress:g} Pa; allowed: {allowed}")
        return self

    @model_validator(mode="after")
    def _surcharge_belongs_to_geostatic(self) -> "InitialStressSection":
        if self.surcharge > 0 and self.kind != "geostatic":
            raise ValueError("a surcharge belongs to kind = 'geostatic', and to no other")
        return self


class BodySection(Section):
    """A body: shape, material, initial state."""

    material: str = Field(description="name of a [material.NAME] table")
    shape: AnyShape = Field(description="rectangle, disc, polygon or mesh; in 3D box, cylinder, cone, sphere or mesh")
    clip: bool = Field(
        default=False,
        description="leave out what of the shape lies outside the domain, for halves and quarters beside planes of "
        "symmetry; by default that is refused",
    )
    density: float = Field(gt=0, le=LARGEST_DENSITY, description="initial bulk density [kg/m3]")
    points_per_cell: Literal[1, 4, 8, 9, 16, 25, 27, 36, 64] = Field(
        default=4,
        description="material points per cell, a square number; may be left to `accuracy`; in 3D a cube number, "
        "default: 8",
    )
    lattice_shift: list[Annotated[float, Field(ge=-0.5, le=0.5)]] = Field(
        default=[],
        description="shift of the points along each axis off their places within the cells, over the distance between "
        "them, to see what a result owes to these places; default: none [1]",
    )
    velocity: Vector = Field(default=(0.0, 0.0), description="initial velocity [m/s]")
    initial_stress: InitialStressSection = Field(
        default=InitialStressSection(),
        description="stress at the start; a law whose stiffness grows with pressure, as Cam Clay, needs one",
    )

    @field_validator("velocity")
    @classmethod
    def _velocity_has_a_bound(cls, velocity: Vector) -> Vector:
        refuse_beyond(velocity, LARGEST_SPEED, "m/s")
        return velocity
