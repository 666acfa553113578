"""Text tables: YADE's `export.textExt`, the columns of our YADE decks, and CSV with one row per grain and time.

# time 0.05                               #format x_y_z_r              time,x,y,z,vx,vy,vz,radius
# id type x y z vx vy vz radius           0.1 0.0 0.2 0.007            0.05,0.1,0.0,0.2,0.0,0.0,-0.1,0.007
0 1 0.1 0.0 0.2 0.0 0.0 -0.1 0.007
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from grainlaw.materials import InputError
from grainlaw.validation.grains.readers.raw_frame import RawFrame, frame_of_rows, parsed_rows, read_text

YADE_FORMAT = "#format"


def recognises(path: Path, start: bytes) -> bool:
    """A commented header with a column x, or a first line of names separated by commas."""
    text = start.decode("utf-8", errors="replace")
    return any("x" in _names(line) for line in text.splitlines() if line.strip()[:1] in ("#", '"') or "," in line)


def frames(path: Path) -> Iterator[RawFrame]:
    """The frames of a table, in the order of their times. Raises InputError for a malformed one."""
    lines = read_text(path)
    header = next((number for number, line in enumerate(lines) if "x" in _names(line)), None)
    if header is None:
        raise InputError(f"{path}: no line names the columns x, y, z and radius")
    names = _names(lines[header])
    body = header + 1
    while body < len(lines) and lines[body].startswith("#"):
        body += 1
    rows = [line for line in lines[body:] if line.strip()]
    if not rows:
        raise InputError(f"{path}: no grains follow its header")
    values = parsed_rows(path, rows, len(names), body + 1, "," if "," in lines[header] else None)
    if "time" not in names:
        yield frame_of_rows(path, names, values, _time(path, lines[:body]))
        return
    times = values[:, names.index("time")]
    for time in np.unique(times):
        yield frame_of_rows(path, names, values[times == time], float(time))


def _names(line: str) -> list[str]:
    """The names of columns that a line holds, if it is a header."""
    text = line.strip()
    if text.startswith(YADE_FORMAT):
        return text.removeprefix(YADE_FORMAT).strip().split("_")
    if "," in text:
        return [name.strip().strip('"') for name in text.lstrip("#").split(",")]
    return text.lstrip("#").split() if text.startswith("#") else []


def _time(path: Path, header: list[str]) -> float | None:
    for line in header:
        words = line.lstrip("#").replace(":", " ").replace("=", " ").split()
        if len(words) == 2 and words[0] == "time":
            try:
                return float(words[1])
            except ValueError:
                raise InputError(f"{path}: time '{words[1]}' is not a number") from None
    return None
