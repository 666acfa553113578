"""MercuryDPM `.data` in three dimensions: frames of a line `N time xmin ymin zmin xmax ymax zmax` and N rows of 14.

A row holds x y z, vx vy vz, the radius, three angles, three angular velocities and the species.
"""

from collections.abc import Iterator
from pathlib import Path

from grainlaw.materials import InputError
from grainlaw.validation.grains.readers.columns import parsed_columns
from grainlaw.validation.grains.readers.raw_frame import RawFrame
from grainlaw.validation.grains.readers.text_file import read_text

ENDING = ".data"
NAMES = ["x", "y", "z", "vx", "vy", "vz", "radius", "qx", "qy", "qz", "wx", "wy", "wz", "type"]
HEADER, HEADER_IN_THE_PLANE = 8, 6


def recognises(path: Path, start: bytes) -> bool:
    """By the ending, and a first line of a whole number and five or seven more."""
    words = start.decode("utf-8", errors="replace").partition("\n")[0].split()
    if ENDING not in path.suffixes or len(words) not in (HEADER, HEADER_IN_THE_PLANE):
        return False
    try:
        return int(words[0]) >= 0 and all(abs(float(word)) >= 0 for word in words[1:])
    except ValueError:
        return False


def frames(path: Path) -> Iterator[RawFrame]:
    """All frames of a file. Raises InputError for a truncated one and for one in two dimensions."""
    lines = read_text(path)
    position = 0
    while position < len(lines):
        words = lines[position].split()
        if not words:
            position += 1
            continue
        if len(words) == HEADER_IN_THE_PLANE:
            raise InputError(f"{path} is a two-dimensional run of MercuryDPM; expected three dimensions, y the depth")
        try:
            count, time = int(words[0]), float(words[1])
            if count < 0:
                raise ValueError(words[0])
        except (ValueError, IndexError):
            raise InputError(
                f"{path}, line {position + 1}: expected the number of grains, the time and the box"
            ) from None
        first = position + 1
        rows = lines[first : first + count]
        if len(rows) < count:
            raise InputError(f"{path}: {len(rows)} of {count} rows at t = {time:g} s; the file is truncated")
        yield RawFrame(path, parsed_columns(path, NAMES, rows, first + 1), time, complete=True)
        position = first + count
