"""`grainlaw scenes`: the scenes that come with grainlaw."""

import typer

WIDTH = 140


def scenes() -> None:
    """List the scenes that come with grainlaw; `run` and `plan` take their names.

    The cost of a run grows with the points times the duration over the cell size; `grainlaw plan SCENE` tells it.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from grainlaw.face.scenes import COLUMNS, described
    from grainlaw.face.scenes import scenes as shipped

    table = Table(box=box.SIMPLE_HEAD)
    for heading in COLUMNS:
        table.add_column(heading, no_wrap=heading != "title", justify="right" if heading == "points" else "left")
    for name, scene in shipped().items():
        table.add_row(*described(name, scene))
    Console(width=WIDTH, markup=False).print(table)
    typer.echo("run one:  grainlaw run SCENE;  what it will cost:  grainlaw plan SCENE")
