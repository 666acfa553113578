"""`grainlaw calibrate`: parameters of a law from element-test data."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from grainlaw.cli.options import PluginFiles, assigned, load_plugins, numbers

if TYPE_CHECKING:
    from grainlaw.materials.calibration.findings import Findings


def calibrate(
    law: Annotated[str, typer.Argument(metavar="LAW", help="Name of the law.")],
    data: Annotated[
        list[Path],
        typer.Argument(
            metavar="DATA.csv...",
            help="Element-test data, all fitted together; `plane_shear_liggghts` comes with grainlaw.",
            show_default=False,
        ),
    ],
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
            metavar="SET|FILE.toml", help="Where the search begins; by default the law's first parameter set."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="Write parameters.toml, calibration.json and fit.png into this folder."
        ),
    ] = None,
    plugin: PluginFiles = None,
) -> None:
    """Fit parameters of a law to element-test data: estimates, 95 % intervals, and what the data do not determine."""
    load_plugins(plugin)
    fixed = numbers(assigned(fix, "--fix"), "--fix")

    from grainlaw.materials.calibration.findings import Findings
    from grainlaw.materials.calibration.fit import calibrate as fitted_to
    from grainlaw.materials.calibration.shipped import data_file

    files = [data_file(path) for path in data]
    found = fitted_to(law, files, fit or (), fixed, parameters)
    findings = Findings(found)
    _print_findings(findings)
    if out is not None:
        from grainlaw.materials.calibration.figures import draw
        from grainlaw.materials.calibration.files import write_files

        for path in write_files(findings, out, partial(draw, findings, found.model)):
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
