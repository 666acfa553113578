"""`grainlaw dem`: our own runs of grains with LIGGGHTS and YADE."""

from pathlib import Path
from typing import Annotated

import typer

dem = typer.Typer(
    help="Runs of grains with LIGGGHTS and YADE, from one description of each case.", no_args_is_help=True
)


@dem.command("list")
def list_cases() -> None:
    """List the cases: what each is, the packings that each code runs by default, and what the reference set lacks."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from grainlaw.validation.dem.catalogue import CASES
    from grainlaw.validation.dem.coverage import missing_runs, seeds_told
    from grainlaw.validation.reference.reference_set import REFERENCE

    table = Table(box=box.SIMPLE_HEAD)
    for heading in ("case", "what it is", "LIGGGHTS seeds", "YADE seeds", "not in the reference set"):
        table.add_column(heading, no_wrap=heading == "case")
    for case in CASES:
        seeds = (" ".join(str(seed) for seed in case.seeds(code)) for code in ("liggghts", "yade"))
        table.add_row(case.name, case.purpose, *seeds, seeds_told(missing_runs(case, REFERENCE)))
    Console(width=140, markup=False).print(table)


@dem.command("run")
def run(
    names: Annotated[list[str], typer.Argument(metavar="CASE...", help="Cases to run.", show_default=False)],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder of the runs.")] = Path("runs/dem"),
    code: Annotated[str | None, typer.Option("--code", help="Only liggghts or only yade.")] = None,
    seed: Annotated[
        list[int] | None, typer.Option("--seed", help="Packing instead of the default ones; repeatable.")
    ] = None,
    time_limit: Annotated[float, typer.Option("--time-limit", help="Longest time for one deck [s].")] = 7200.0,
) -> None:
    """Run cases that are not finished yet; what is finished in the folder is kept.

    Exit code 1 if a run fails. Ctrl-C and SIGTERM end the running code too; the same command then goes on.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from grainlaw.materials import InputError, SimulationError
    from grainlaw.validation.dem.batch import case_named, perform_all
    from grainlaw.validation.dem.programs import PROGRAMS
    from grainlaw.validation.dem.runs import Run, finished, runs_of
    from grainlaw.validation.dem.stopping import Stopped, noting_stop_requests

    if code is not None and code not in PROGRAMS:
        raise InputError(f"--code {code}: allowed are {', '.join(PROGRAMS)}")
    runs = [found for name in names for found in runs_of(case_named(name), code, tuple(seed or ()))]
    console = Console(stderr=True)
    columns = (MofNCompleteColumn(), BarColumn(), TimeElapsedColumn(), TextColumn("{task.fields[state]}"))
    with (
        noting_stop_requests() as stop_request,
        Progress(*columns, console=console, disable=not console.is_terminal) as bar,
    ):
        task = bar.add_task("", total=len(runs), state="")

        def report(current: Run, line: str) -> None:
            bar.update(task, completed=runs.index(current), state=f"{current.name}: {line}")
            stop_request.obey()

        try:
            outcomes = perform_all(runs, out, time_limit, report)
        except Stopped as stopped:
            count = sum(finished(one, out) for one in runs)
            raise SimulationError(
                f"stopped by {stopped}; {count} of {len(runs)} runs are finished in {out}, "
                "the same command goes on with the others"
            ) from None
        bar.update(task, completed=len(runs))
    for outcome in outcomes:
        typer.echo(f"{outcome.run.name}: {outcome.text}")
    if any(outcome.failed for outcome in outcomes):
        raise typer.Exit(1)


@dem.command("reduce")
def reduce(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of runs, as `dem run --out` made it.")],
    into: Annotated[Path, typer.Option("--into", metavar="DIR", help="Folder of the reference set.")],
) -> None:
    """Reduce finished runs to a reference set: an observation for each collapse, tables of shear and compression."""
    from grainlaw.validation.dem.reduction import reduce_runs

    for path in reduce_runs(folder, into):
        typer.echo(str(path))
