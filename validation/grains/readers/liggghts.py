"""LIGGGHTS and LAMMPS `dump custom` as text: one or more frames, each with step, number of grains, box and a table."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from grainlaw.materials import InputError
from grainlaw.validation.grains.readers.columns import parsed_columns, settled
from grainlaw.validation.grains.readers.raw_frame import RawFrame
from grainlaw.validation.grains.readers.text_file import read_text
from grainlaw.validation.grains.snapshot import Array

ITEM = "ITEM:"
TABLE = ("ITEM: ATOMS", "ITEM: ENTRIES")
SCALED = ("s", "su")
UNWRAPPED = ("u", "su")
AXES = "xyz"


@dataclass
class _Header:
    """What stands before the table of a frame; `box` holds the lower and upper end of each axis [m]."""

    step: int | None = None
    time: float | None = None
    count: int | None = None
    flags: list[str] = field(default_factory=list)
    box: list[list[float]] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    first: int = 0


def recognises(path: Path, start: bytes) -> bool:
    """A dump consists of items; one of contacts has entries, not atoms."""
    return start.startswith(ITEM.encode()) and b"ITEM: ENTRIES" not in start


def frames(path: Path) -> Iterator[RawFrame]:
    """All frames of a dump. Raises InputError for a truncated or malformed one, and for other units than SI."""
    lines = read_text(path)
    position = 0
    while position < len(lines):
        if not lines[position].strip():
            position += 1
            continue
        header = _header(path, lines, position)
        count, first = header.count or 0, header.first
        rows = lines[first : first + count]
        if len(rows) < count:
            raise InputError(f"{path}: {len(rows)} of {count} rows at step {header.step}; the file is truncated")
        # A column of contacts has no name that says whether it is needed.
        of_contacts = lines[first - 1].startswith("ITEM: ENTRIES")
        needed = set(header.names) if of_contacts else None
        columns = parsed_columns(path, header.names, rows, first + 1, needed=needed)
        columns = columns if of_contacts else settled(_with_positions(path, columns, header))
        yield RawFrame(path, columns, header.time, header.step, complete=True)
        position = first + count


def _header(path: Path, lines: list[str], position: int) -> _Header:
    """The header of the frame that starts at a line."""
    header = _Header()
    for number in range(position, len(lines)):
        line = lines[number]
        if line.startswith(TABLE):
            if header.step is None or header.count is None:
                break
            header.names = line.split()[2:]
            header.first = number + 1
            return header
        if line.startswith(ITEM):
            try:
                _take_item(path, header, line, lines[number + 1 : number + 4])
            except (ValueError, IndexError):
                wanted = "three rows of numbers" if line.startswith("ITEM: BOX") else "a number"
                raise InputError(f"{path}, line {number + 2}: expected {wanted} after '{line}'") from None
    raise InputError(
        f"{path}, line {position + 1}: no step, number of grains and 'ITEM: ATOMS' follow; is it truncated?"
    )


def _take_item(path: Path, header: _Header, line: str, values: list[str]) -> None:
    if line.startswith("ITEM: TIMESTEP"):
        header.step = int(values[0])
    elif line.startswith("ITEM: TIME"):
        header.time = float(values[0])
    elif line.startswith("ITEM: NUMBER OF"):
        header.count = _number_of_rows(values[0])
    elif line.startswith("ITEM: UNITS") and values[0].strip() != "si":
        raise InputError(f"{path} is in the units '{values[0].strip()}' of LAMMPS; expected 'si'")
    elif line.startswith("ITEM: BOX BOUNDS"):
        header.flags = line.split()[3:]
        header.box = [[float(word) for word in row.split()] for row in values]


def _number_of_rows(text: str) -> int:
    if (count := int(text)) < 0:
        raise ValueError(text)
    return count


def _with_positions(path: Path, columns: dict[str, Array], header: _Header) -> dict[str, Array]:
    """The columns with x, y and z from scaled (xs), unwrapped (xu) or scaled unwrapped (xsu) ones.

    Unwrapped positions are put back into the box along its periodic axes, where LAMMPS writes x.
    """
    found = dict(columns)
    for number, axis in enumerate(AXES):
        ending = next((ending for ending in ("s", "u", "su") if axis + ending in columns), None)
        if axis in columns or ending is None:
            continue
        values = columns[axis + ending]
        if "xy" in header.flags or any(len(row) != 2 for row in header.box):
            raise InputError(f"{path}: {axis}{ending} in a box that is not rectangular; dump {axis} instead")
        if len(header.box) != len(AXES):
            if ending in SCALED:
                raise InputError(f"{path}: {axis}{ending} counts from the box, but 'ITEM: BOX BOUNDS' is missing")
            found[axis] = values
            continue
        lower, upper = header.box[number]
        if ending in SCALED:
            values = lower + values * (upper - lower)
        if ending in UNWRAPPED and header.flags[number : number + 1] == ["pp"] and upper > lower:
            values = lower + np.mod(values - lower, upper - lower)
        found[axis] = values
    return found
