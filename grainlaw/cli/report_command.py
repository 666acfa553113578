"""`grainlaw report`: one page of runs and of comparisons with grains."""

from pathlib import Path
from typing import Annotated

import typer


def report(
    folders: Annotated[
        list[Path],
        typer.Argument(
            metavar="DIR...",
            help="Folders of finished runs, of `validate dem` and of `compare --dem --out`, in any mixture.",
            show_default=False,
        ),
    ],
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="Folder of report.html, report.md and report.json.")
    ] = Path("runs/report"),
) -> None:
    """Write one self-contained page, and the same as Markdown and JSON; nothing is computed again."""
    from grainlaw.validation.report.whole_report import write_whole_report
    from grainlaw.validation.report.write import prepare

    prepare(out)
    for path in write_whole_report(folders, out):
        typer.echo(f"  {path}")
