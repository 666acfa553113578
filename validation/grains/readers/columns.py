"""Columns of numbers by name, from the rows of a text table and from what codes call differently."""

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from grainlaw.materials import InputError
from grainlaw.validation.grains.snapshot import Array

# One name for what codes call differently.
ALIASES = {
    "r": "radius",
    "rad": "radius",
    "radii": "radius",
    "diam": "diameter",
    "mask": "type",
    "rho": "density",
    "Time": "time",
}
VECTORS = {"Points": ("x", "y", "z")} | dict.fromkeys(("v", "vel", "velocity", "linVel"), ("vx", "vy", "vz"))
# ParaView's CSV numbers the components of a vector; others name its axes.
ALIASES |= {
    form.format(vector, number, "xyz"[number]): part
    for vector, parts in VECTORS.items()
    for form in ("{0}:{1}", "{0}_{1}", "{0}[{1}]", "{0}_{2}")
    for number, part in enumerate(parts)
}
# A text in any other column is a remark.
NEEDED = {"x", "y", "z", "vx", "vy", "vz", "radius", "diameter", "type", "time"}


def settled(columns: Mapping[str, Array]) -> dict[str, Array]:
    """Columns under the names of this library; a column that has such a name goes before one that means the same."""
    found = {ALIASES[name]: values for name, values in columns.items() if name in ALIASES}
    found |= {name: values for name, values in columns.items() if name not in ALIASES}
    if "radius" not in found and "diameter" in found:
        found["radius"] = 0.5 * found["diameter"]
    return found


def parsed_columns(
    path: Path,
    names: list[str],
    lines: list[str],
    first_line: int,
    separator: str | None = None,
    needed: set[str] | None = None,
) -> dict[str, Array]:
    """Columns by name, each of shape (rows,); a column of texts is left out unless it is `needed` (None: `NEEDED`).

    Raises InputError for a short or long row and for a text in a column that is needed.
    """
    try:
        rows = [line.split() for line in lines] if separator is None else list(csv.reader(lines, delimiter=separator))
    except csv.Error as error:
        raise InputError(f"{path}: {error} from line {first_line} on") from None
    for number, row in enumerate(rows):
        if len(row) != len(names):
            raise InputError(
                f"{path}, line {first_line + number}: {len(row)} of {len(names)} columns; is the file truncated?"
            )
    try:
        table = np.array(rows, float).reshape(-1, len(names))
    except ValueError:
        return _numeric_columns(path, names, rows, first_line, NEEDED if needed is None else needed)
    return dict(zip(names, table.T, strict=True))


def _numeric_columns(
    path: Path, names: list[str], rows: list[list[str]], first_line: int, needed: set[str]
) -> dict[str, Array]:
    columns = {}
    for name, texts in zip(names, zip(*rows, strict=True), strict=True):
        try:
            columns[name] = np.array(texts, float)
        except ValueError:
            if name in needed or ALIASES.get(name) in needed:
                row = next(number for number, text in enumerate(texts) if not _is_number(text))
                raise InputError(f"{path}, line {first_line + row}: {name} = '{texts[row]}' is not a number") from None
    return columns


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
