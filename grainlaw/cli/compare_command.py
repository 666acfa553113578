"""`grainlaw compare`: finished runs side by side."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from grainlaw.mpm_core.output.run_folder import RunFolder
    from grainlaw.validation.report.page import Section


def compare(
    folders: Annotated[
        list[Path], typer.Argument(metavar="DIR...", help="Folders of finished runs.", show_default=False)
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Also draw snapshots.png and history.png into this folder."),
    ] = None,
    field: Annotated[str, typer.Option("--field", help="Field of the snapshots.")] = "shear_strain",
    dem: Annotated[
        list[Path] | None,
        typer.Option(
            "--dem",
            metavar="FILE",
            help="Grains or an experiment to judge the runs by: a run's folder with run.json, a dump beside one, HDF5, "
            "or a CSV of t, x, h; repeatable.",
        ),
    ] = None,
    mpm: Annotated[
        list[Path] | None,
        typer.Option(
            "--mpm",
            metavar="FILE",
            help="A state of another MPM code to put the runs beside: its points in npz, CSV, VTK (.vtk, .vtp, .vtu) "
            "or PLY, or a CSV of t, x, h; repeatable.",
        ),
    ] = None,
) -> None:
    """Print a table of the final states, and draw the snapshots at equal normalised runout (the paper's Figure 2).

    With --dem: print how far each run is from the grains, and with --out write a page with profiles over time.
    With --mpm: print how far each run is from the piles of other codes, and with --out write a page with both.
    """
    from rich.console import Console
    from rich.table import Table

    from grainlaw.mpm_core.output.history import energy_unit
    from grainlaw.mpm_core.output.run_folder import RunFolder
    from grainlaw.mpm_core.output.summary import in_digits

    if dem or mpm:
        _judge(folders, dem or [], mpm or [], out)
        return
    runs = [(folder.name, RunFolder(folder)) for folder in folders]
    table = Table()
    for heading in (
        "run",
        "law",
        "points",
        "runout [m]",
        "height [m]",
        "centre of mass [m]",
        "kinetic energy",
        "wall [s]",
    ):
        table.add_column(heading, justify="left" if heading in ("run", "law") else "right")
    for name, run in runs:
        summary = run.summary
        final = summary.final
        table.add_row(
            name,
            summary.material,
            f"{summary.points:,}",
            f"{final.runout:.4f}",
            f"{final.height:.4f}",
            in_digits(final.center_of_mass_height),
            f"{final.kinetic_energy:.3g} {energy_unit(run.space)}",
            f"{summary.wall_time:.1f}",
        )
    Console(width=120, markup=False).print(table)
    if out is not None:
        _draw(runs, out, field)


def _judge(folders: list[Path], dem: list[Path], mpm: list[Path], out: Path | None) -> None:
    from grainlaw.validation.report.own_codes import TITLE as BESIDE_CODES
    from grainlaw.validation.report.own_grains import TITLE as AGAINST_GRAINS
    from grainlaw.validation.report.own_grains import write_page
    from grainlaw.validation.report.write import prepare

    if out is not None:
        prepare(out)
    sections = [*([_against_grains(folders, dem)] if dem else []), *([_beside_codes(folders, mpm)] if mpm else [])]
    if out is not None:
        references = [*(f"--dem {path}" for path in dem), *(f"--mpm {path}" for path in mpm)]
        command = f"grainlaw compare {' '.join(str(path) for path in folders)} {' '.join(references)} --out {out}"
        title = AGAINST_GRAINS if dem else BESIDE_CODES
        typer.echo(f"  {write_page(out, title, sections, command)}")


def _against_grains(folders: list[Path], dem: list[Path]) -> "Section":
    from grainlaw.cli.dem_report_command import print_table
    from grainlaw.validation.report.own_grains import grains_section, judged_runs

    ensemble, judgements = judged_runs(folders, dem)
    for run in ensemble.runs:
        if lost := run.description.get("grains_lost"):
            typer.echo(f"warning: {run.label}: {lost} grains left the box; the others are compared", err=True)
    section = grains_section(ensemble, judgements)
    print_table(section.tables[0])
    return section


def _beside_codes(folders: list[Path], mpm: list[Path]) -> "Section":
    from grainlaw.cli.dem_report_command import print_table
    from grainlaw.validation.report.own_codes import codes_section, runs_beside_codes

    section = codes_section(runs_beside_codes(folders, mpm))
    print_table(section.tables[0])
    return section


def _draw(runs: list[tuple[str, "RunFolder"]], out: Path, field: str) -> None:
    from grainlaw.mpm_core.output.pictures import draw_history
    from grainlaw.mpm_core.output.shown_field import usual_limits
    from grainlaw.mpm_core.output.snapshots import draw_snapshots

    out.mkdir(parents=True, exist_ok=True)
    draw_snapshots(runs, out / "snapshots.png", field, usual_limits(field))
    draw_history(runs, out / "history.png")
    for picture in ("snapshots.png", "history.png"):
        typer.echo(f"  {out / picture}")
