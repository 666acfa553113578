"""`grainlaw check`: the conformance suite on a law."""

from typing import Annotated

import typer

from grainlaw.cli.options import PluginFiles, load_plugins
from grainlaw.materials import registry

WIDTH = 140


def check(
    law: Annotated[str, typer.Argument(metavar="LAW", help="Name of the law.")],
    quick: Annotated[bool, typer.Option("--quick", help="Fewer paths and draws and no box, for every change.")] = False,
    plugin: PluginFiles = None,
) -> None:
    """Try a law on what every law has to satisfy: one line per check, exit code 1 if one fails."""
    load_plugins(plugin)
    chosen = registry().get(law).law

    from rich import box
    from rich.console import Console
    from rich.table import Table

    from grainlaw.materials.conformance.finished import unfinished
    from grainlaw.materials.conformance.suite import CHECKS, FULL, QUICK, examine
    from grainlaw.validation.box import BOX

    table = Table(box=box.SIMPLE_HEAD)
    for heading in ("check", "verdict", "reason"):
        table.add_column(heading, no_wrap=heading != "reason")
    failed = []
    for found, outcome in examine(chosen, QUICK) if quick else examine(chosen, FULL, (*CHECKS, BOX)):
        table.add_row(found.name, outcome.verdict, outcome.reason)
        if outcome.verdict == "FAIL":
            failed.append(found.name)
    Console(width=WIDTH, markup=False).print(table)
    for left in unfinished(chosen):
        typer.echo(f"unfinished: {left}")
    typer.echo(f"{law}: " + (f"fails {', '.join(failed)}" if failed else "passes every check that could be made"))
    if failed:
        raise typer.Exit(1)
