"""CSV with a line of names and a row for each point; the names may stand behind a `#`."""

import csv
from pathlib import Path

from grainlaw.materials import InputError
from grainlaw.validation.grains.readers.columns import parsed_columns
from grainlaw.validation.grains.readers.text_file import read_text
from grainlaw.validation.mpm.readers.names import is_known
from grainlaw.validation.mpm.readers.point_table import PointTable, refuse_too_many, table_of_arrays


def recognises(path: Path, start: bytes) -> bool:
    """Text with commas in one of its first lines."""
    try:
        text = start.decode("utf-8")
    except UnicodeDecodeError as error:
        # The end of what was read may cut a letter in two.
        text = start[: error.start].decode("utf-8") if error.start > len(start) - 4 else ""
    return "," in text


def read_table(path: Path) -> PointTable:
    """The columns of numbers. Raises InputError in one line for a malformed or truncated table."""
    lines = read_text(path)
    first = next((number for number, line in enumerate(lines) if "," in line), len(lines))
    if first == len(lines):
        raise InputError(f"{path}: no line names its columns, separated by commas")
    names = [name.strip().strip('"') for name in next(csv.reader([lines[first].lstrip("# ")]))]
    rows = [line for line in lines[first + 1 :] if line.strip() and not line.startswith("#")]
    refuse_too_many(path, len(rows))
    needed = {name for name in names if is_known(name)}
    return table_of_arrays(path, parsed_columns(path, names, rows, first + 2, ",", needed))
