"""Contacts beside a dump of grains: LIGGGHTS `dump local` of `compute pair/gran/local pos id force`, or a text table.

# x1 y1 z1 x2 y2 z2 id1 id2 periodic fx fy fz
0.1 0.0 0.02 0.1 0.0 0.035 1 2 0 0.0 0.0 -0.04

Centres of the two grains [m] and the force on the first [N].
"""

from pathlib import Path

import numpy as np

from grainlaw.materials import InputError
from grainlaw.materials.errors import nearest_name
from grainlaw.validation.grains.readers import liggghts
from grainlaw.validation.grains.readers.columns import parsed_columns
from grainlaw.validation.grains.readers.text_file import read_start, read_text
from grainlaw.validation.grains.snapshot import Array

NAMES = ("x1", "y1", "z1", "x2", "y2", "z2", "id1", "id2", "periodic", "fx", "fy", "fz")
FIRST, SECOND, FORCE = NAMES[:3], NAMES[3:6], NAMES[9:]


def read_contacts(path: Path) -> tuple[Array, Array, Array]:
    """Centres of the first and of the second grains and the force on the first, each (n, 3).

    Raises InputError in one line for a file that is missing, damaged or no table of contacts.
    """
    if not path.is_file():
        raise InputError(f"{path} does not exist; run.json names it as a file of contacts")
    start = liggghts.ITEM.encode()
    columns = _of_liggghts(path) if read_start(path, len(start)) == start else _of_text(path)
    for name in (*FIRST, *SECOND, *FORCE):
        if name not in columns:
            raise InputError(f"{path} has no column '{name}': {nearest_name(name, columns)}")
    first, second, force = (np.column_stack([columns[name] for name in part]) for part in (FIRST, SECOND, FORCE))
    if not all(np.isfinite(values).all() for values in (first, second, force)):
        raise InputError(f"{path}: values that are no finite numbers")
    return first, second, force


def _of_liggghts(path: Path) -> dict[str, Array]:
    """LIGGGHTS numbers the columns of a compute; their order is that of its keywords pos, id, force."""
    columns = next(liggghts.frames(path)).columns
    if len(columns) != len(NAMES):
        raise InputError(
            f"{path}: {len(columns)} columns, expected the {len(NAMES)} of compute pair/gran/local pos id force"
        )
    return dict(zip(NAMES, columns.values(), strict=True))


def _of_text(path: Path) -> dict[str, Array]:
    """A header of names, commented, and a row for each contact; none while all grains fly."""
    lines = read_text(path)
    names = lines[0].lstrip("#").split()
    rows = [line for line in lines[1:] if line.strip()]
    return parsed_columns(path, names, rows, 2, needed=set(NAMES))
