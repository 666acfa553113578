"""What the tables of a scene file are made of."""

from collections.abc import Iterable
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

# Beyond these a number is a slip of the unit, or overflows on its way through a run.
LARGEST_SPEED, LARGEST_GRAVITY, LARGEST_DENSITY = 1e6, 1e6, 1e6  # m/s, m/s2, kg/m3
LARGEST_PRESSURE, LARGEST_RATIO = 1e12, 1e3  # Pa, 1


class Section(BaseModel):
    """A table of a scene file; unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)


# As many components as the space of the scene has axes, which `space_rules` sees to.
Vector = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=3)]


def refuse_beyond(vector: Iterable[float], largest: float, unit: str) -> None:
    """Raises ValueError if one of its components is larger, or negative and larger."""
    for component in vector:
        if abs(component) > largest:
            raise ValueError(f"{component:g} {unit} is out of bounds; allowed: {-largest:g} to {largest:g} {unit}")
