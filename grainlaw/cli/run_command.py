"""`grainlaw run`: a scene from its file or by its name to a run's folder."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from grainlaw.cli.options import PluginFiles, counted, load_plugins, stops_told
from grainlaw.cli.scene_options import SceneFile, SetValues, load_scene

if TYPE_CHECKING:
    from grainlaw.mpm_core.output.summary import RunSummary

# Share of the energy released above which the user is told what transfers took.
LARGE_BALANCE_ERROR = 0.1


def run(
    scene_file: SceneFile,
    set_values: SetValues = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Folder of the run; default: runs/NAME of the scene."),
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on from the folder's checkpoint.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the run that the folder holds.")] = False,
    threads: Annotated[
        int | None,
        typer.Option("--threads", min=1, metavar="N", help="Threads; default: the idle cores. Same bits for any."),
    ] = None,
    plugins: PluginFiles = None,
) -> None:
    """Run a scene and write ParaView files, history, summary, checkpoint and pictures."""
    load_plugins(plugins)
    scene = load_scene(scene_file, set_values)
    folder = out or Path("runs") / scene_file.stem

    from grainlaw.mpm_core.parallel.threads import usable_threads
    from grainlaw.mpm_core.stepping.run import run as run_scene
    from grainlaw.progress import shown_progress

    with (
        stops_told("stopped by Ctrl-C before the first step; nothing was written"),
        shown_progress(scene.time.end, lines_otherwise=True) as progress,
    ):
        summary = run_scene(
            scene,
            folder,
            threads=usable_threads(threads),
            resume=resume,
            overwrite=overwrite,
            progress=progress,
        )
    _print_result(folder, summary, scene.in_space.amount)


def _print_result(folder: Path, summary: "RunSummary", amount: str) -> None:
    from grainlaw.mpm_core.output.summary import in_digits

    final, waited = summary.final, f"{summary.compile_time:.1f} s to compile or load kernels"
    typer.echo(
        f"{summary.scene or folder.name}: t = {summary.simulated_time:g} s, {counted(summary.points, 'point')}, "
        f"{counted(summary.steps, 'step')} in {summary.wall_time:.1f} s, of which {waited} "
        f"({summary.point_steps_per_second / 1e6:.1f} million point-steps/s on {counted(summary.threads, 'thread')})"
    )
    typer.echo(
        f"runout {final.runout:.4f} m, height {final.height:.4f} m, centre of mass "
        f"{in_digits(final.center_of_mass_height)} m, kinetic energy {final.kinetic_energy:.3g} J{amount}"
    )
    points = summary.points + summary.points_in
    if summary.points_in > 0:
        typer.echo(f"{summary.mass_in:.4g} kg{amount} entered, {counted(summary.points_in, 'point')}")
    if summary.points_left > 0:
        all_of_it = ": nothing is left" if summary.points_left == points else ""
        typer.echo(
            f"{summary.mass_left:.4g} kg{amount} left through open sides, {summary.points_left} of "
            f"{counted(points, 'point')}{all_of_it}"
        )
    counts = ", ".join(
        f"{count} {name.removeprefix('points_').replace('_', ' ')}" for name, count in summary.limited.items()
    )
    typer.echo(f"points bounded instead of clipped: {counts}; energy balance error {summary.energy_balance_error:.2%}")
    if summary.energy_balance_error > LARGE_BALANCE_ERROR:
        typer.echo(
            "  of the energy released; transfers take it, most where loose material comes together or a stream stops "
            "(numerical_dissipation in history.csv)"
        )
    for name in ("run.pvd", "run.vtkhdf", "history.csv", "summary.json"):
        if (folder / name).exists():
            typer.echo(f"  {folder / name}")
    for picture in [*sorted(folder.glob("*.png")), *folder.glob("movie.mp4")]:
        typer.echo(f"  {picture}")
