"""`quantities.csv`: name, unit and meaning of everything that the files of a run hold, one row per quantity.

It is the place where a reader sees the units: ParaView, a spreadsheet and a text editor all open it, while the arrays
and columns keep plain names.
"""

import csv
import io
from collections.abc import Iterable
from pathlib import Path

from grainlaw.materials import InputError, atomic
from grainlaw.mpm_core.output.forces import FORCES_NAME
from grainlaw.mpm_core.output.frame import Field
from grainlaw.mpm_core.output.history import HISTORY_NAME, HistoryColumn, history_columns
from grainlaw.mpm_core.space import PLANE_STRAIN, Space

QUANTITIES_NAME = "quantities.csv"
POINT_FILES = "points_*.vtu"


def write_quantities(
    folder: Path, fields: Iterable[Field], space: Space = PLANE_STRAIN, forces: Iterable[HistoryColumn] = ()
) -> None:
    """Write the table for the given fields of the points and all columns of the history, as they are in the space.

    `forces` are the columns of the forces on obstacles.
    """
    table = io.StringIO(newline="")
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(["file", "name", "unit", "doc"])
    writer.writerows([POINT_FILES, field.name, field.unit, field.doc] for field in fields)
    writer.writerows([HISTORY_NAME, column.name, column.unit, column.doc] for column in history_columns(space))
    writer.writerows([FORCES_NAME, column.name, column.unit, column.doc] for column in forces)
    atomic.write_text(folder / QUANTITIES_NAME, table.getvalue())


def read_field_documentation(folder: Path) -> dict[str, tuple[str, str]]:
    """Unit and doc of each point field by its name; empty where the table is missing.

    Raises InputError where it cannot be read.
    """
    path = folder / QUANTITIES_NAME
    if not path.is_file():
        return {}
    try:
        with path.open(newline="") as table:
            rows = [row for row in csv.DictReader(table) if row["file"] == POINT_FILES]
        return {row["name"]: (row["unit"], row["doc"]) for row in rows}
    except (KeyError, ValueError, csv.Error) as error:
        raise InputError(f"{path} cannot be read: {error}") from error
