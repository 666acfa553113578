"""`grainlaw sweep`: a scene run for each combination of varied values."""

from pathlib import Path
from typing import Annotated

import typer

from grainlaw.cli.options import PluginFiles, assigned, counted, load_plugins, stops_told
from grainlaw.cli.scene_options import SceneFile, SetValues

MOST_REASONS = 5


def sweep(
    scene_file: SceneFile,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="KEY=a:b:n",
            help="Vary a value of the scene: n values from a to b, [v1,v2], or with --samples a:b; repeatable.",
        ),
    ] = None,
    set_values: SetValues = None,
    samples: Annotated[
        int | None,
        typer.Option(
            "--samples", min=1, metavar="N", help="Runs of a Latin hypercube over the ranges, or draws with --from."
        ),
    ] = None,
    parameters: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="FILE.toml",
            help="Draw from the estimate and covariance in this file, which `grainlaw calibrate` wrote.",
        ),
    ] = None,
    sobol: Annotated[
        bool, typer.Option("--sobol", help="Make N (keys + 2) runs, N a power of two, for Sobol indices.")
    ] = False,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Of hypercubes, Sobol designs and draws.")] = 0,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Folder of all runs; default: runs/NAME-sweep of the scene."),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="A Dask scheduler; default: processes on this machine."),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option("--workers", min=1, metavar="N", help="Processes on this machine; default: its cores."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Leave the folder's finished runs alone, go on with the others.")
    ] = False,
    plugins: PluginFiles = None,
) -> None:
    """Run a scene for each combination of varied values, and write a table and a page of what came of them.

    A run that fails is a row with its reason; the others go on.
    """
    load_plugins(plugins)
    varied = assigned(vary, "--vary")

    from grainlaw.mpm_core.scene.file import value_of_text
    from grainlaw.studies.sweep import sweep as sweep_scene

    with stops_told("stopped by Ctrl-C before the first run"):
        found = sweep_scene(
            scene_file,
            out or Path("runs") / f"{scene_file.stem}-sweep",
            varied,
            samples=samples,
            parameters=parameters,
            sobol=sobol,
            seed=seed,
            changes={key: value_of_text(text) for key, text in assigned(set_values).items()},
            scheduler=scheduler,
            workers=workers,
            resume=resume,
        )
    finished = len(found.outcomes) - len(found.failed)
    typer.echo(f"{counted(len(found.outcomes), 'run')}: {finished} finished, {len(found.failed)} failed")
    for outcome in found.failed[:MOST_REASONS]:
        typer.echo(f"  {outcome.name}: {outcome.reason}")
    if len(found.failed) > MOST_REASONS:
        typer.echo(f"  and {len(found.failed) - MOST_REASONS} more, each with its reason in the table")
    for path in found.files:
        typer.echo(f"  {path}")
