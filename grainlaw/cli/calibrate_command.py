"""`grainlaw calibrate`: parameters of a law from element-test data, or from profiles of grains by running a scene."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from grainlaw.cli.options import PluginFiles, assigned, load_plugins, numbers, stops_told
from grainlaw.cli.scene_options import SetValues, load_scene
from grainlaw.materials import InputError

if TYPE_CHECKING:
    from grainlaw.materials.calibration.findings import Findings
    from grainlaw.materials.calibration.fit import ElementFit
    from grainlaw.studies.scene_fit import SceneFit


def calibrate(
    law: Annotated[str, typer.Argument(metavar="LAW", help="Name of the law.")],
    data: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="DATA.csv...",
            help="Element-test data, all fitted together; `plane_shear_liggghts` comes with grainlaw.",
            show_default=False,
        ),
    ] = None,
    fit: Annotated[
        list[str] | None,
        typer.Option(
            "--fit", metavar="PARAMETER", help="Fit this parameter; repeatable; default: all that the data depend on."
        ),
    ] = None,
    fix: Annotated[
        list[str] | None, typer.Option("--fix", metavar="NAME=VALUE", help="Hold a parameter, in SI units; repeatable.")
    ] = None,
    parameters: Annotated[
        str | None,
        typer.Option(
            metavar="SET|FILE.toml",
            help="Where the search begins; by default the law's first parameter set, with --scene that of the scene.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="Write parameters.toml, calibration.json and fit.png into this folder; with --scene the runs, too, by "
            "default into runs/calibrate_LAW.",
        ),
    ] = None,
    scene: Annotated[
        Path | None, typer.Option("--scene", metavar="SCENE", help="Run this scene, and fit its profile to --dem.")
    ] = None,
    dem: Annotated[
        list[Path] | None,
        typer.Option("--dem", metavar="FILE", help="Grains or an experiment; as for `compare --dem`; repeatable."),
    ] = None,
    set_values: SetValues = None,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="Dask scheduler for --scene; default: processes here."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option("--workers", min=1, metavar="N", help="Processes for --scene; default: the cores.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Keep the runs of --scene that are finished.")] = False,
    plugin: PluginFiles = None,
) -> None:
    """Fit parameters of a law to element-test data: estimates, 95 % intervals, and what the data do not determine.

    With --scene and --dem: fit them to the profile of grains at the end of a scene, by running it.
    """
    load_plugins(plugin)
    fixed = numbers(assigned(fix, "--fix"), "--fix")
    if scene is not None:
        if data:
            raise InputError(
                f"{data[0]}: element-test data and --scene are fitted one at a time; leave out one of them"
            )
        found = _fitted_to_scene(
            law,
            scene,
            set_values,
            dem,
            fit,
            fixed,
            parameters,
            out,
            scheduler=scheduler,
            workers=workers,
            resume=resume,
        )
        _report_scene_fit(found, out or _folder(law))
        return
    if dem or set_values or scheduler or workers or resume:
        raise InputError("--dem, --set, --scheduler, --workers and --resume belong to --scene")
    if not data:
        raise InputError("DATA.csv is missing: name files of element tests, or --scene SCENE --dem FILE")

    from grainlaw.materials.calibration.findings import Findings
    from grainlaw.materials.calibration.fit import calibrate as fitted_to
    from grainlaw.materials.calibration.shipped import data_file

    files = [data_file(path) for path in data]
    of_tests = fitted_to(law, files, fit or (), fixed, parameters)
    findings = Findings(of_tests)
    _print_findings(findings)
    if len({found.file for found in of_tests.model.data}) > 1:
        _print_told(findings, of_tests)
    if out is not None:
        from grainlaw.materials.calibration.figures import draw
        from grainlaw.materials.calibration.files import write_files

        for path in write_files(findings, out, partial(draw, findings, of_tests.model)):
            typer.echo(f"  {path}")


def _folder(law: str) -> Path:
    return Path("runs") / f"calibrate_{law}"


def _fitted_to_scene(
    law_name: str,
    scene: Path,
    set_values: list[str] | None,
    dem: list[Path] | None,
    fit: list[str] | None,
    fixed: dict[str, float],
    parameters: str | None,
    out: Path | None,
    *,
    scheduler: str | None,
    workers: int | None,
    resume: bool,
) -> "SceneFit":
    from grainlaw.materials.element.specimen import base_values
    from grainlaw.materials.registry import get_material
    from grainlaw.studies.scene_fit import fit_scene
    from grainlaw.validation.report.write import prepare

    law = get_material(law_name)
    start = base_values(law, parameters)[0] if parameters else {}
    loaded = load_scene(scene, set_values)
    folder = out or _folder(law_name)
    prepare(folder)
    with stops_told():
        return fit_scene(
            law,
            loaded,
            dem or (),
            fit or (),
            folder,
            start=start,
            fixed=fixed,
            scheduler=scheduler,
            workers=workers,
            resume=resume,
        )


def _report_scene_fit(found: "SceneFit", out: Path) -> None:
    from grainlaw.materials.calibration.files import write_files
    from grainlaw.materials.calibration.findings import Findings
    from grainlaw.studies.scene_fit_picture import draw, notes

    findings = Findings(found)
    _print_findings(findings)
    for note in notes(found):
        typer.echo(f"note: {note}")
    for path in write_files(findings, out, partial(draw, findings, found)):
        typer.echo(f"  {path}")


def _print_findings(findings: "Findings") -> None:
    fit = findings.fit
    size, freedom = fit.residuals.size, findings.freedom
    typer.echo(f"{fit.law.name}, {size} measurements, {fit.solution.size} parameters:")
    width = max(len(found.name) for found in findings.estimates)
    for found in findings.estimates:
        unit = "" if found.unit == "1" else f" {found.unit}"
        verdict = "" if found.determined else "   not determined"
        interval = f"[{found.lower:.4g}, {found.upper:.4g}]"
        typer.echo(f"  {found.name:<{width}} = {found.value:.5g}{unit}   95 %: {interval}{verdict}")
    if len(findings.estimates) > 1:
        typer.echo("correlation:")
        for found, row in zip(findings.estimates, findings.correlation.tolist(), strict=True):
            typer.echo(f"  {found.name:<{width}} " + " ".join(f"{value:7.3f}" for value in row))
    if fit.knows_errors:
        typer.echo(f"chi2 = {findings.misfit:.4g} with {freedom} degrees of freedom")
    else:
        typer.echo(f"scatter about the law: {(findings.misfit / freedom) ** 0.5:.3g} of the size of the data")
    for remark in findings.remarks:
        typer.echo(f"note: {remark}")


def _print_told(findings: "Findings", fit: "ElementFit") -> None:
    """Which file determines which parameter."""
    from grainlaw.materials.calibration.told_by import told_by

    typer.echo("told by one file alone, the other parameters held:")
    told = told_by(findings, fit.model)
    width = max(len(found.name) for found in findings.estimates)
    for estimate in findings.estimates:
        files = [f"{one.file} [{one.lower:.4g}, {one.upper:.4g}]" for one in told if one.name == estimate.name]
        typer.echo(f"  {estimate.name:<{width}}   {'; '.join(files) or 'none'}")
