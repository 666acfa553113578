"""What a file holds before it is known which run it belongs to: columns by name, and a time or a step."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from grainlaw.materials import InputError
from grainlaw.materials.errors import nearest_name
from grainlaw.validation.grains.snapshot import Array, GrainSnapshot, sphere_diameters, sphere_volumes

# One name for what codes call differently.
ALIASES = {"r": "radius", "rad": "radius", "radii": "radius", "mask": "type"}
# Larger grains than this are taken for lengths in millimetres.
LARGEST_DIAMETER = 1.0


@dataclass(frozen=True)
class RawFrame:
    """Columns of one time, each of shape (n,), with the names of `ALIASES` settled.

    time [s], step and the file of the contacts where told
    """

    path: Path
    columns: dict[str, Array]
    time: float | None = None
    step: int | None = None
    contacts: Path | None = None


class Reader(Protocol):
    """A module that reads one format."""

    def recognises(self, path: Path, start: bytes) -> bool:
        """Whether a file with this name and these first bytes is in this format."""
        ...

    def frames(self, path: Path) -> Iterator[RawFrame]:
        """All frames of a file. Raises InputError in one line."""
        ...


def frame_of_rows(
    path: Path, names: list[str], rows: Array, time: float | None = None, step: int | None = None
) -> RawFrame:
    """A frame from a table with one row for each grain."""
    columns = {ALIASES.get(name, name): rows[:, number] for number, name in enumerate(names)}
    return RawFrame(path, columns, time, step)


def parsed_rows(path: Path, lines: list[str], columns: int, first_line: int, separator: str | None = None) -> Array:
    """Numbers of a text table, shape (rows, columns). Raises InputError for a short, long or non-numeric row."""
    rows = [line.split(separator) for line in lines]
    for number, row in enumerate(rows):
        if len(row) != columns:
            raise InputError(
                f"{path}, line {first_line + number}: {len(row)} of {columns} columns; is the file truncated?"
            )
    try:
        return np.array(rows, float).reshape(-1, columns)
    except ValueError as error:
        raise InputError(f"{path}: {error} from line {first_line} on") from None


def read_text(path: Path) -> list[str]:
    """Lines of a text file. Raises InputError if it is empty or no text."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except UnicodeDecodeError:
        raise InputError(f"{path} is no text file") from None
    if not any(line.strip() for line in lines):
        raise InputError(f"{path} is empty")
    return lines


def snapshot_of(frame: RawFrame, time: float, mobile_types: tuple[int, ...] | None) -> GrainSnapshot:
    """The grains of a frame that count. Raises InputError for missing columns, bad numbers or wrong units."""
    columns = _mobile(frame, mobile_types)
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
    if radii.min() <= 0.0:
        raise InputError(f"{frame.path}: a radius of {radii.min():g} m; it must be above 0")
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


def _mobile(frame: RawFrame, mobile_types: tuple[int, ...] | None) -> dict[str, Array]:
    if "type" not in frame.columns:
        return frame.columns
    types = frame.columns["type"]
    if mobile_types is None:
        if len(found := np.unique(types).tolist()) > 1:
            raise InputError(
                f"{frame.path} holds grains of the types {[round(kind) for kind in found]}; "
                "mobile_types in run.json must say which ones count"
            )
        return frame.columns
    mobile = np.isin(types, mobile_types)
    return {name: values[mobile] for name, values in frame.columns.items()}


def _column(path: Path, columns: dict[str, Array], name: str) -> Array:
    if name not in columns:
        raise InputError(f"{path} has no column '{name}': {nearest_name(name, columns)}")
    return columns[name]
