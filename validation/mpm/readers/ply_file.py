"""PLY, text or binary: all numbers of its vertices.

The libraries at hand refuse vertices without z, as codes in the plane write them, and trust the count in the header.
Here the file must be as long as its header says, so that no count takes more memory than the file has.
"""

import io
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from grainlaw.materials import InputError
from grainlaw.validation.mpm.readers.point_table import PointTable, refuse_too_many, table_of_arrays

SIGNATURE = b"ply"
END = b"end_header"
LONGEST_HEADER = 2**16
VERTEX = "vertex"
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    "int64": "i8",
    "uint64": "u8",
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}


@dataclass
class _Header:
    """The order of bytes (empty: text), the number of vertices, and name and type of each of their numbers."""

    order: str | None = None
    count: int | None = None
    columns: list[tuple[str, str]] = field(default_factory=list)


def recognises(path: Path, start: bytes) -> bool:
    """By the first line."""
    return start[:4].strip() == SIGNATURE


def read_table(path: Path) -> PointTable:
    """The numbers of the vertices by name. Raises InputError in one line for a damaged or truncated file."""
    content = path.read_bytes()
    end = content.find(END, 0, LONGEST_HEADER)
    body = content.find(b"\n", end) + 1
    if end < 0 or body == 0:
        raise InputError(f"{path} cannot be read as PLY: its header has no end")
    try:
        header = _header(content[:end].decode("ascii").splitlines())
        rows = _rows(header, content[body:])
    except (ValueError, KeyError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read as PLY: {error}") from None
    refuse_too_many(path, len(rows))
    return table_of_arrays(path, {name: rows[name].astype(float) for name, _ in header.columns})


def _header(lines: list[str]) -> _Header:
    header = _Header()
    element = ""
    for words in (line.split() for line in lines[1:]):
        match words:
            case ["format", kind, *_]:
                header.order = ORDERS[kind]
            case ["element", name, count]:
                if name != VERTEX and header.count is None:
                    raise ValueError(f"its first element is '{name}', expected '{VERTEX}'")
                element = name
                if name == VERTEX:
                    header.count = int(count)
            case ["property", "list", *_] if element == VERTEX:
                raise ValueError("its vertices hold lists")
            case ["property", kind, name] if element == VERTEX:
                if kind not in TYPES:
                    raise ValueError(f"'{kind}' of {name} is no type of PLY")
                header.columns.append((name, TYPES[kind]))
    if header.order is None or header.count is None or header.count < 0 or not header.columns:
        raise ValueError("its header tells no format, or no vertices")
    return header


def _rows(header: _Header, body: bytes) -> np.ndarray:
    """The vertices as a structured array. Raises ValueError where the file ends before the last of them."""
    kinds = np.dtype([(name, f"{header.order}{kind}") for name, kind in header.columns])
    count = header.count or 0
    if header.order:
        if len(body) < count * kinds.itemsize:
            raise ValueError(f"{len(body) // kinds.itemsize} of {count} vertices; is it truncated?")
        return np.frombuffer(body, kinds, count)
    lines = body.decode("ascii").splitlines()[:count]
    if len(lines) < count:
        raise ValueError(f"{len(lines)} of {count} vertices; is it truncated?")
    if not lines:
        return np.zeros(0, kinds)
    return np.atleast_1d(np.loadtxt(io.StringIO("\n".join(lines)), kinds))
