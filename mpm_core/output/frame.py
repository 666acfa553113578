"""A frame: the points of all bodies at one time, in the order in which they were generated."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.materials.errors import nearest_name


@dataclass(frozen=True)
class Field:
    """One quantity at all points: name, SI unit, doc, values of shape (points,) or (points, 3)."""

    name: str
    unit: str
    doc: str
    values: NDArray[np.float64]

    def stored_values(self) -> NDArray[np.float32]:
        """The values as every file format stores them: single precision, finer than any picture or plot resolves."""
        return np.ascontiguousarray(self.values, dtype=np.float32)


@dataclass(frozen=True)
class Frame:
    """Time [s], step number, positions [m] of shape (points, 3) and the fields that the scene asks for."""

    time: float
    step: int
    positions: NDArray[np.float64]
    fields: tuple[Field, ...]

    def field(self, name: str) -> Field:
        """The field of that name.

        Raises InputError if the frame does not hold it.
        """
        by_name = {field.name: field for field in self.fields}
        if name not in by_name:
            raise InputError(f"no field '{name}' in the frame at t = {self.time:g} s: {nearest_name(name, by_name)}")
        return by_name[name]
