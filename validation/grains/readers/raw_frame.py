"""What a file holds before it is known which run it belongs to: columns by name, and a time or a step."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from grainlaw.materials import InputError
from grainlaw.materials.errors import nearest_name
from grainlaw.validation.grains.snapshot import Array, GrainSnapshot, sphere_diameters, sphere_volumes

# Larger grains than this are taken for lengths in millimetres.
LARGEST_DIAMETER = 1.0
# Positions [m] and velocities [m/s] beyond this are those of no grains.
LARGEST = 1e9


@dataclass(frozen=True)
class RawFrame:
    """Columns of one time, each of shape (n,), with the names that `columns.settled` gives.

    time [s], step and the file of the contacts where told
    complete   the file tells its number of grains and holds them all: it is not cut off
    """

    path: Path
    columns: dict[str, Array]
    time: float | None = None
    step: int | None = None
    contacts: Path | None = None
    complete: bool = False


class Reader(Protocol):
    """A module that reads one format."""

    def recognises(self, path: Path, start: bytes) -> bool:
        """Whether a file with this name and these first bytes is in this format."""
        ...

    def frames(self, path: Path) -> Iterator[RawFrame]:
        """All frames of a file. Raises InputError in one line."""
        ...


def snapshot_of(frame: RawFrame, time: float, mobile_types: tuple[int, ...] | None) -> GrainSnapshot:
    """The grains of a frame that count. Raises InputError for missing columns, bad numbers or wrong units."""
    columns = mobile_columns(frame, mobile_types)
    positions = np.column_stack([_column(frame.path, columns, name) for name in "xyz"])
    radii = _column(frame.path, columns, "radius")
    if len(radii) == 0:
        raise InputError(f"{frame.path}: no grain of the types {list(mobile_types or [])}")
    velocities = np.full_like(positions, np.nan)
    if any(name in columns for name in ("vx", "vy", "vz")):
        velocities = np.column_stack([_column(frame.path, columns, name) for name in ("vx", "vy", "vz")])
    for name, values in (("positions", positions), ("radii", radii)):
        if not np.isfinite(values).all():
            raise InputError(f"{frame.path}: {name} that are no finite numbers")
    for name, values in (("a position", positions), ("a velocity", velocities)):
        largest = float(np.nan_to_num(np.abs(values)).max())
        if largest > LARGEST:
            raise InputError(f"{frame.path}: {name} of {largest:g} in SI units; is the file damaged?")
    if radii.min() <= 0.0:
        raise InputError(f"{frame.path}: a radius of {radii.min():g} m; it must be above 0")
    with np.errstate(over="ignore"):
        diameter = float(sphere_diameters(sphere_volumes(radii)).mean())
    if diameter > LARGEST_DIAMETER:
        raise InputError(
            f"{frame.path}: the mean grain diameter is {diameter:g} m, allowed up to {LARGEST_DIAMETER:g} m; "
            "is the file in millimetres?"
        )
    if len(radii) > 1 and np.ptp(positions[:, 1]) == 0.0:
        raise InputError(
            f"{frame.path}: all grains have y = {positions[0, 1]:g} m; expected three dimensions, y the depth"
        )
    return GrainSnapshot(time, positions, velocities, sphere_volumes(radii))


def mobile_count(frame: RawFrame, mobile_types: tuple[int, ...] | None) -> int:
    """Number of grains of a frame that count."""
    return len(_column(frame.path, mobile_columns(frame, mobile_types), "x"))


def mobile_columns(frame: RawFrame, mobile_types: tuple[int, ...] | None) -> dict[str, Array]:
    """The columns of the grains that count. Raises InputError where several types do not say which."""
    if "type" not in frame.columns:
        return frame.columns
    types = frame.columns["type"]
    if mobile_types is None:
        if len(found := np.unique(types).tolist()) > 1:
            raise InputError(
                f"{frame.path} holds grains of the types {', '.join(f'{kind:g}' for kind in found)}; "
                "mobile_types in run.json must say which ones count"
            )
        return frame.columns
    mobile = np.isin(types, mobile_types)
    return {name: values[mobile] for name, values in frame.columns.items()}


def _column(path: Path, columns: dict[str, Array], name: str) -> Array:
    if name not in columns:
        raise InputError(f"{path} has no column '{name}': {nearest_name(name, columns)}")
    return columns[name]
