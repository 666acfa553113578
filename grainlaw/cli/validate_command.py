"""`grainlaw validate`: the laws and the core against exact and published answers."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from grainlaw.cli.dem_report_command import SUITE, judge_by_grains

if TYPE_CHECKING:
    from grainlaw.validation.case import Case
    from grainlaw.validation.result import CaseResult

WIDTH = 140


def validate(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[CASE]...", help="Cases or suites to run; default: the suite standard.", show_default=False
        ),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Coarse and short, for every change.")] = False,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Write results.json, junit.xml and report.html into this folder."),
    ] = None,
    list_cases: Annotated[
        bool, typer.Option("--list", help="List the suites, their cases and what each proves.")
    ] = False,
) -> None:
    """Run validation cases or suites: each case has a reference, a band and a negative control that must leave it.

    `grainlaw validate dem` stands alone: it fits the laws to shear and compression of grains, judges them on collapses
    of grains, and writes dem.html, dem.md and dem.json; default folder: runs/dem_report.

    Exit code 1 if a case leaves its band or a control does not.
    """
    if names == [SUITE]:
        judge_by_grains(out, quick)
        return

    from grainlaw.validation.catalogue import SUITES, chosen_cases

    if list_cases:
        for suite in names or SUITES:
            _print_list(suite, chosen_cases([suite]))
        return
    cases = chosen_cases(names or [])

    from grainlaw.validation.case import Effort
    from grainlaw.validation.result import run_cases

    if out is not None:
        from grainlaw.validation.report.write import prepare

        prepare(out)
    results = run_cases(
        cases, Effort.QUICK if quick else Effort.FULL, lambda case: typer.echo(f"{case.name} ...", err=True)
    )
    _print_results(results)
    if out is not None:
        from grainlaw.validation.report.case_report import write_report

        for path in write_report(out, results):
            typer.echo(f"  {path}")
    if not all(result.passed for result in results):
        raise typer.Exit(1)


def _print_list(title: str, cases: "Sequence[Case]") -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD)
    table.add_column("case", no_wrap=True)
    table.add_column("proves")
    table.add_column("the control's mistake")
    for case in cases:
        table.add_row(case.name, case.proves, case.mistake)
    Console(width=WIDTH, markup=False).print(table)


def _print_results(results: "Sequence[CaseResult]") -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("case", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    table.add_column("decisive measurement", overflow="fold")
    for heading in ("error", "band", "control", "order", "wall [s]"):
        table.add_column(heading, justify="right", no_wrap=True)
    for result in results:
        table.add_row(*_row(result))
    console = Console(width=WIDTH, markup=False)
    console.print(table)
    for result in results:
        _print_details(result)
    typer.echo(f"{sum(result.passed for result in results)} of {len(results)} cases pass")


def _row(result: "CaseResult") -> list[str]:
    worst, control = result.worst, result.worst_of_control
    return [
        result.case.name,
        "pass" if result.passed else "FAIL",
        "" if worst is None else worst.name,
        "" if worst is None else f"{worst.error:.2e}",
        "" if worst is None else f"{worst.band:.0e}",
        "" if control is None else f"{control.error:.2e}",
        ", ".join(f"{found.fitted_order:.2f}" for found in result.evidence.convergence),
        f"{result.wall_time:.1f}",
    ]


def _print_details(result: "CaseResult") -> None:
    """Observed orders, and why a case failed."""
    for found in result.evidence.convergence:
        steps = ", ".join(f"{size:.3g}: {error:.2e}" for size, error in zip(found.sizes, found.errors, strict=True))
        orders = ", ".join(f"{order:.2f}" for order in found.orders)
        typer.echo(f"{result.case.name}: {found.name} over {found.against}: {steps}; orders {orders}")
    for note in result.evidence.notes:
        typer.echo(f"{result.case.name}: {note}")
    for reason in result.reasons:
        typer.echo(f"{result.case.name} FAILS: {reason}")
