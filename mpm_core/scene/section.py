"""What the tables of a scene file are made of."""

import math
from collections.abc import Iterable
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

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


def number_or_three(what: str, largest: float, unit: str) -> BeforeValidator:
    """Takes a number, or three in 3D, up to `largest`; refuses all else in one line, which calls it `what`."""

    def checked(value: Any) -> float | tuple[float, ...]:
        entries = list(value) if isinstance(value, list | tuple) else [value]
        are_numbers = all(type(entry) in (int, float) and math.isfinite(entry) for entry in entries)
        if not are_numbers or (isinstance(value, list | tuple) and len(entries) != 3):
            raise ValueError(f"{value!r:.60} is no {what}; allowed: a number, in 3D three numbers")
        refuse_beyond(entries, largest, unit)
        return tuple(map(float, entries)) if isinstance(value, list | tuple) else float(value)

    return BeforeValidator(checked)
