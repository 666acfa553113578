"""`grainlaw movie`: the frames of runs as a film."""

from pathlib import Path
from typing import Annotated

import typer

OF_SEVERAL = Path("runs/movie.mp4")


def movie(
    folders: Annotated[list[Path], typer.Argument(metavar="RUN...", help="Folders of runs.", show_default=False)],
    field: Annotated[
        str | None,
        typer.Option("--field", help="Field of the colours, a vector by its length; default: that of the pictures."),
    ] = None,
    side_by_side: Annotated[
        bool, typer.Option("--side-by-side", help="Put several runs into a row, not below one another.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="FILE",
            help="File of the film, .mp4 (H.264) or .gif; default: movie.mp4 in the folder of the run, of several "
            f"runs {OF_SEVERAL}.",
        ),
    ] = None,
) -> None:
    """Make a film of the frames of a run, or of several at equal times; colours mean the same in all of them."""
    from rich.console import Console

    from grainlaw.mpm_core.output.film import FILM_NAME, write_film
    from grainlaw.mpm_core.output.run_folder import RunFolder
    from grainlaw.progress import progress_bar

    runs = [(folder.resolve().name, RunFolder(folder)) for folder in folders]
    path = out or (folders[0] / FILM_NAME if len(folders) == 1 else OF_SEVERAL)
    console = Console(stderr=True)
    progress = progress_bar(console)
    progress.disable = not console.is_terminal
    with progress as bar:
        task = bar.add_task("", total=1, state="")
        write_film(
            runs,
            path,
            field,
            side_by_side=side_by_side,
            report=lambda done, count: bar.update(task, completed=done, total=count, state=f"frame {done} of {count}"),
        )
    typer.echo(f"  {path}")
