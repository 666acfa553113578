"""The sides of the domain: walls, open sides, and sides that are joined to their opposites."""

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from grainlaw.mpm_core.scene.section import LARGEST_SPEED, Section, number_or_three
from grainlaw.mpm_core.space import Space


class WallSection(Section):
    """A wall, an open side, or a side joined to its opposite."""

    kind: Literal["free_slip", "no_slip", "friction", "periodic", "open"] = Field(
        description="free_slip and no_slip hold the material at the wall; friction lets it leave and slide; at an open "
        "side there is no wall, and what goes through it is gone"
    )
    coefficient: float = Field(default=0.0, ge=0, description="Coulomb friction coefficient of a friction wall [1]")
    velocity: Annotated[float | tuple[float, float, float], number_or_three("velocity", LARGEST_SPEED, "m/s")] = Field(
        default=0.0,
        description="at which a friction or no_slip wall slides along itself: a number, towards +x or +y; in 3D three "
        "components, the one across the wall zero [m/s]",
    )

    @model_validator(mode="after")
    def _coefficient_belongs_to_friction(self) -> "WallSection":
        if self.kind == "friction" and "coefficient" not in self.model_fields_set:
            raise ValueError("kind = 'friction' needs a coefficient")
        if self.kind != "friction" and self.coefficient > 0:
            raise ValueError("a coefficient belongs to kind = 'friction', and to no other")
        return self

    @model_validator(mode="after")
    def _velocity_belongs_to_a_wall_that_grips(self) -> "WallSection":
        if self.moves and self.kind not in ("friction", "no_slip"):
            raise ValueError("a velocity belongs to kind = 'friction' or 'no_slip', which can pass it on")
        return self

    @property
    def moves(self) -> bool:
        """Whether the wall has a velocity."""
        return any(self.velocity) if isinstance(self.velocity, tuple) else self.velocity != 0.0


class BoundarySection(Section):
    """What happens at the sides of the domain."""

    left: WallSection = Field(
        default=WallSection(kind="free_slip"), description="side x = lower; in axisymmetry the axis, if x = 0"
    )
    right: WallSection = Field(default=WallSection(kind="free_slip"), description="side x = upper")
    front: WallSection | None = Field(default=None, description="side y = lower, in 3D; default: free_slip")
    back: WallSection | None = Field(default=None, description="side y = upper, in 3D; default: free_slip")
    bottom: WallSection = Field(default=WallSection(kind="free_slip"), description="side y = lower, in 3D z = lower")
    top: WallSection = Field(default=WallSection(kind="free_slip"), description="side y = upper, in 3D z = upper")

    @field_validator("*", mode="before")
    @classmethod
    def _short_form(cls, value: Any) -> Any:
        return {"kind": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _periodic_in_pairs(self) -> "BoundarySection":
        for first, second in (("left", "right"), ("front", "back"), ("bottom", "top")):
            kinds = {self.kind_of(first), self.kind_of(second)}
            if "periodic" in kinds and len(kinds) > 1:
                raise ValueError(f"periodic sides come in pairs: set both {first} and {second}")
        return self

    def of(self, side: str) -> WallSection:
        """What happens at a side of the space."""
        section = getattr(self, side)
        return section if isinstance(section, WallSection) else WallSection(kind="free_slip")

    def kind_of(self, side: str) -> str:
        """The kind of a side."""
        return self.of(side).kind

    def refuse_for(self, space: Space, left_is_axis: bool) -> None:
        """Raises ValueError for sides that the space does not have, and for what they cannot do in it."""
        sides = [side for pair in space.sides for side in pair]
        for side in ("front", "back"):
            if side not in sides and getattr(self, side) is not None:
                raise ValueError(f"boundary.{side}: space = '{space.name}' has no such side; {', '.join(sides)}")
        for axis, pair in enumerate(space.sides):
            for side in pair:
                self._refuse_velocity(side, axis, space)
        if left_is_axis and self.left.kind != "free_slip":
            raise ValueError(
                f"boundary.left = '{self.left.kind}': the left side is the axis, x = 0, where no wall can stand; "
                "leave it out, or let grid.lower begin beside the axis"
            )
        if space.hoop and self.right.kind == "periodic":
            raise ValueError("boundary.right = 'periodic': nothing repeats along the radius of an axisymmetric scene")

    def _refuse_velocity(self, side: str, axis: int, space: Space) -> None:
        wall = self.of(side)
        if not wall.moves:
            return
        value = list(wall.velocity) if isinstance(wall.velocity, tuple) else wall.velocity
        key = f"boundary.{side}.velocity = {value}"
        if isinstance(wall.velocity, tuple) != (space.axes == 3):
            takes = "three components" if space.axes == 3 else "a number"
            raise ValueError(f"{key}: space = '{space.name}' takes {takes}")
        if isinstance(wall.velocity, tuple) and wall.velocity[axis] != 0.0:
            raise ValueError(
                f"{key}: a wall slides along itself; allowed: 0 along {space.axis_names[axis]}, across the wall"
            )
        if space.hoop and axis == space.up:
            raise ValueError(f"{key}: no floor slides along the radius everywhere; allowed: 0")
