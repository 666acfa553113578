"""LIGGGHTS `dump custom` as text: one or more frames, each with step, number of grains, box and a table."""

from collections.abc import Iterator
from pathlib import Path

from grainlaw.materials import InputError
from grainlaw.validation.grains.readers.raw_frame import RawFrame, frame_of_rows, parsed_rows, read_text

TABLE = ("ITEM: ATOMS", "ITEM: ENTRIES")


def recognises(path: Path, start: bytes) -> bool:
    """A dump starts with its step; one of contacts has entries, not atoms."""
    return start.startswith(b"ITEM: TIMESTEP") and b"ITEM: ENTRIES" not in start


def frames(path: Path) -> Iterator[RawFrame]:
    """All frames of a dump. Raises InputError for a truncated or malformed one."""
    lines = read_text(path)
    position = 0
    while position < len(lines):
        step, count, names, first = _header(path, lines, position)
        rows = lines[first : first + count]
        if len(rows) < count:
            raise InputError(f"{path}: {len(rows)} of {count} rows at step {step}; the file is truncated")
        yield frame_of_rows(path, names, parsed_rows(path, rows, len(names), first + 1), step=step)
        position = first + count


def _header(path: Path, lines: list[str], position: int) -> tuple[int, int, list[str], int]:
    """Step, number of rows, names of the columns and the first row of the frame that starts at a line."""
    step: int | None = None
    count: int | None = None
    for number in range(position, len(lines)):
        line = lines[number]
        try:
            if line.startswith("ITEM: TIMESTEP"):
                step = int(lines[number + 1])
            elif line.startswith("ITEM: NUMBER OF"):
                count = int(lines[number + 1])
        except (ValueError, IndexError):
            raise InputError(f"{path}, line {number + 2}: expected a whole number after '{line}'") from None
        if line.startswith(TABLE):
            if step is None or count is None:
                break
            return step, count, line.split()[2:], number + 1
    raise InputError(
        f"{path}, line {position + 1}: no step, number of grains and 'ITEM: ATOMS' follow; is it truncated?"
    )
