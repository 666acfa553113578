"""Tables of a benchmark: on the terminal, as Markdown and as JSON."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table as RichTable

from grainlaw.materials import atomic

WIDTH = 140


@dataclass(frozen=True)
class Table:
    """A titled table of text."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def as_markdown(self) -> str:
        """The table as GitHub shows it."""
        lines = [self.headings, tuple("---" for _ in self.headings), *self.rows]
        return f"### {self.title}\n\n" + "".join(f"| {' | '.join(line)} |\n" for line in lines)


def print_table(table: Table) -> None:
    """Print one table."""
    shown = RichTable(title=table.title, box=box.SIMPLE_HEAD, title_justify="left")
    for number, heading in enumerate(table.headings):
        shown.add_column(heading, justify="right" if number else "left")
    for row in table.rows:
        shown.add_row(*row)
    Console(width=WIDTH, markup=False).print(shown)


def write(folder: Path, numbers: dict[str, Any], tables: Sequence[Table]) -> list[Path]:
    """Write benchmark.json and benchmark.md; return their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    json_file, page = folder / "benchmark.json", folder / "benchmark.md"
    atomic.write_text(json_file, json.dumps(numbers, indent=2, default=asdict) + "\n")
    atomic.write_text(page, "\n".join(table.as_markdown() for table in tables))
    return [json_file, page]
