"""`grainlaw view`: a page that plays a run."""

from pathlib import Path
from typing import Annotated

import typer


def view(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.", show_default=False)],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE.html", help="File of the page; default: view.html in the folder."),
    ] = None,
) -> None:
    """Write one HTML page that plays the frames of a run in any browser; it needs nothing else, nor a network."""
    from grainlaw.mpm_core.output.run_folder import RunFolder
    from grainlaw.player.page import PAGE_NAME, write_page

    typer.echo(f"  {write_page(RunFolder(folder), out or folder / PAGE_NAME)}")
