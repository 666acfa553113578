"""Tables that grow by a row at a time while a run goes on."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, atomic


class RowsWriter:
    """Appends rows to a CSV file; each row reaches the file before `append` returns."""

    def __init__(self, path: Path, types: Mapping[str, type]) -> None:
        """Continue the table, or start one; `types` are those of its columns.

        Raises InputError for a table with other columns.
        """
        self.types = dict(types)
        if not path.exists():
            atomic.write_text(path, _line(types))
        elif _complete_lines(path)[:1] != [_line(types)]:
            raise InputError(f"{path} has other columns: another version began the run; --overwrite begins it again")
        # Without a buffer, from which a row that did not fit on the disk would be written again.
        self._file = path.open("ab", buffering=0)

    def append(self, values: Mapping[str, float]) -> None:
        """Append one row; `values` holds exactly the declared columns.

        Raises ValueError naming the columns that are missing or not declared.
        """
        if values.keys() != self.types.keys():
            raise ValueError(f"row and declared columns differ in {sorted(values.keys() ^ self.types.keys())}")
        row = memoryview(_line(repr(kind(values[name])) for name, kind in self.types.items()).encode())
        while row:
            row = row[self._file.write(row) :]

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def keep_rows(path: Path, rows: int) -> None:
    """Remove all but the first rows, those of the checkpoint from which the run resumes.

    Raises InputError if the table is missing.
    """
    _refuse_missing(path)
    atomic.write_text(path, "".join(_complete_lines(path)[: 1 + rows]))


def read_rows(path: Path, types: Mapping[str, type]) -> NDArray[Any]:
    """A table as a structured array of shape (rows,), one named field per column, by default of floats.

    A last row that is still being written is left out. Raises InputError if the file is missing or cannot be read.
    """
    _refuse_missing(path)
    try:
        lines = _complete_lines(path)
        if not lines:
            raise InputError(f"{path} is empty")
        names = lines[0].strip().split(",")
        dtype = np.dtype([(name, types.get(name, float)) for name in names])
        return np.loadtxt(lines[1:], delimiter=",", dtype=dtype, ndmin=1) if len(lines) > 1 else np.empty(0, dtype)
    except ValueError as error:
        raise InputError(f"{path} cannot be read: {error}") from error


def _refuse_missing(path: Path) -> None:
    if not path.is_file():
        raise InputError(f"{path.parent} holds no {path.name}")


def _line(entries: Iterable[str]) -> str:
    return ",".join(entries) + "\n"


def _complete_lines(path: Path) -> list[str]:
    return [line for line in path.read_text().splitlines(keepends=True) if line.endswith("\n")]
