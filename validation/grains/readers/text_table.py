"""Text tables: YADE's `export.textExt`, the columns of our YADE decks, and CSV, ParaView's too, with a row per grain.

# time 0.05                               #format x_y_z_r_attrs        time,x,y,z,vx,vy,vz,radius
# id type x y z vx vy vz radius           # x y z r vel                0.05,0.1,0.0,0.2,0.0,0.0,-0.1,0.007
0 1 0.1 0.0 0.2 0.0 0.0 -0.1 0.007        0.1 0.0 0.2 0.007 0 0 -0.1
"""

import csv
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np

from grainlaw.materials import InputError
from grainlaw.validation.grains.readers.columns import ALIASES, VECTORS, parsed_columns, settled
from grainlaw.validation.grains.readers.raw_frame import RawFrame
from grainlaw.validation.grains.readers.text_file import read_text

YADE_FORMAT = "#format"
ATTRIBUTES = "attrs"
# Columns of a scalar, a vector and a matrix among YADE's attributes.
WIDTHS = (1, 3, 9)
OTHER_VECTORS = {"angVel", "angMom", "inertia", "refPos", "color"}
# More attributes than this are not told apart.
MOST_ATTRIBUTES = 8


def recognises(path: Path, start: bytes) -> bool:
    """A commented header with a column x, or a first line of names separated by commas."""
    text = start.decode("utf-8", errors="replace")
    return any(_is_header(line) for line in text.splitlines() if line.strip()[:1] in ("#", '"') or "," in line)


def frames(path: Path) -> Iterator[RawFrame]:
    """The frames of a table, in the order of their times. Raises InputError for a malformed one."""
    lines = read_text(path)
    header = next((number for number, line in enumerate(lines) if _is_header(line)), None)
    if header is None:
        raise InputError(f"{path}: no line names the columns x, y, z and radius")
    body = header + 1
    while body < len(lines) and lines[body].startswith("#"):
        body += 1
    rows = [line for line in lines[body:] if line.strip()]
    if not rows:
        raise InputError(f"{path}: no grains follow its header")
    separator = "," if "," in lines[header] else None
    names = _names(lines[header])
    if names[-1] == ATTRIBUTES and lines[header].startswith(YADE_FORMAT):
        names = _with_attributes(names[:-1], lines[header + 1 : body], len(rows[0].split()))
    columns = settled(parsed_columns(path, names, rows, body + 1, separator))
    if "time" not in columns:
        yield RawFrame(path, columns, _time(path, lines[:body]))
        return
    times = columns["time"]
    for time in np.unique(times):
        yield RawFrame(path, {name: values[times == time] for name, values in columns.items()}, float(time))


def _is_header(line: str) -> bool:
    return any(ALIASES.get(name, name) == "x" for name in _names(line))


def _names(line: str) -> list[str]:
    """The names of columns that a line holds, if it is a header."""
    text = line.strip()
    if text.startswith(YADE_FORMAT):
        return text.removeprefix(YADE_FORMAT).strip().split("_")
    if "," in text:
        return [name.strip().strip('"') for name in next(csv.reader([text.lstrip("#")]))]
    return text.lstrip("#").split() if text.startswith("#") else []


def _with_attributes(names: list[str], comments: list[str], columns: int) -> list[str]:
    """The names of all columns of `x_y_z_r_attrs`: the attributes stand on a line of their own, without their widths.

    An attribute whose columns are not certain stays without a name: `attribute 5`.
    """
    named = next((words for words in map(_names, comments) if words[: len(names)] == names), names)
    attributes = named[len(names) :]
    rest = columns - len(names)
    found = [f"attribute {number}" for number in range(rest)]
    possible = _widths(attributes, rest)
    for number, attribute in enumerate(attributes):
        places = {(sum(widths[:number]), widths[number]) for widths in possible}
        if len(places) == 1:
            first, width = places.pop()
            parts = VECTORS.get(_plain(attribute), ()) if width == 3 else (_plain(attribute),) if width == 1 else ()
            found[first : first + len(parts)] = parts
    return names + found


def _widths(attributes: list[str], columns: int) -> list[tuple[int, ...]]:
    """All ways to share columns among attributes; one that is known as a vector has three."""
    if len(attributes) > MOST_ATTRIBUTES:
        return []
    choices = [(3,) if _plain(attribute) in VECTORS.keys() | OTHER_VECTORS else WIDTHS for attribute in attributes]
    return [widths for widths in product(*choices) if sum(widths) == columns]


def _plain(attribute: str) -> str:
    """`b.state.vel` is vel."""
    return attribute.rpartition(".")[2]


def _time(path: Path, header: list[str]) -> float | None:
    for line in header:
        words = line.lstrip("#").replace(":", " ").replace("=", " ").split()
        if len(words) == 2 and words[0] == "time":
            try:
                return float(words[1])
            except ValueError:
                raise InputError(f"{path}: time '{words[1]}' is not a number") from None
    return None
