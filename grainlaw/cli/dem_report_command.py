"""`grainlaw validate dem`: laws fitted to grains and judged on collapses of grains."""

from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from grainlaw.validation.report.page import Table

SUITE = "dem"
FOLDER = Path("runs") / "dem_report"


def judge_by_grains(out: Path | None, quick: bool) -> None:
    """Make the report; exit code 1 if a negative control is not noticed."""
    from grainlaw.validation.case import Effort
    from grainlaw.validation.dem.judging.laws_against_grains import make_report
    from grainlaw.validation.reference.reference_set import read_reference_set
    from grainlaw.validation.report.grain_report import write_report
    from grainlaw.validation.report.grain_tables import scatter_table, summary_table, variant_table
    from grainlaw.validation.report.write import prepare

    folder = out or FOLDER
    effort = Effort.QUICK if quick else Effort.FULL
    reference = read_reference_set()
    prepare(folder)
    report = make_report(reference, folder, effort, lambda text: typer.echo(f"{text} ...", err=True))
    print_table(scatter_table(report.scatter))
    print_table(summary_table(report))
    print_table(variant_table("Negative controls", "Each has to be noticed.", report.controls))
    command = f"grainlaw validate {SUITE}{' --quick' if quick else ''}"
    for path in write_report(folder, report, reference.test("shear"), command):
        typer.echo(f"  {path}")
    if report.missed:
        raise typer.Exit(1)


def print_table(table: "Table") -> None:
    """A table of the report on the terminal."""
    from rich import box
    from rich.console import Console
    from rich.table import Table as Printed

    printed = Printed(title=table.title, caption=table.note, box=box.SIMPLE_HEAD, title_justify="left")
    for name in table.columns:
        printed.add_column(name, overflow="fold")
    for row in table.rows:
        printed.add_row(*row)
    Console(width=150, markup=False).print(printed)
