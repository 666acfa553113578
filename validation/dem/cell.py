"""What a run of a periodic cell leaves: its cost and its reduced table."""

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from grainlaw.materials.atomic import write_text


@dataclass(frozen=True)
class Reduced:
    """Steps made, mobile grains, and the name of the CSV file with the reduced data."""

    steps: int
    grains: int
    table: str


def write_table(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write a reduced table; numbers come as the texts that they are to be, or as they print."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    write_text(path, text.getvalue())
