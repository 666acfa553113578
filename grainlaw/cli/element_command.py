"""`grainlaw element`: a homogeneous element test on one or several materials."""

import math
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from grainlaw.cli.options import PluginFiles, assigned, load_plugins, numbers
from grainlaw.materials import InputError

if TYPE_CHECKING:
    from grainlaw.materials.element.result import ElementResult
    from grainlaw.materials.element.settings import ElementTest

TESTS = (
    "constant-pressure-shear, simple-shear, isotropic, oedometer, triaxial-drained, triaxial-undrained, biaxial, mixed"
)


def element(
    test: Annotated[str, typer.Argument(metavar="TEST", help=f"{TESTS}.")],
    material: Annotated[
        list[str],
        typer.Option("--material", metavar="NAME[:SET]", help="Law, and one of its parameter sets; repeatable."),
    ],
    assignments: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Parameter of the law or setting of the test, in SI units."),
    ] = None,
    parameters: Annotated[
        str | None, typer.Option(metavar="SET|FILE.toml", help="Parameter values; by default the law's first set.")
    ] = None,
    control: Annotated[
        Path | None, typer.Option(metavar="FILE.toml", help="Stages of strain and stress rates, for the test mixed.")
    ] = None,
    out: Annotated[Path | None, typer.Option(metavar="FILE.csv", help="Write the history; one material only.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE.png", help="Draw four panels, all materials.")] = None,
    plugin: PluginFiles = None,
) -> None:
    """Lead one point of a material along the path of an element test."""
    load_plugins(plugin)
    values = numbers(assigned(assignments))

    from grainlaw.face.element_tests import chosen_test
    from grainlaw.materials.element.run import run_element_test
    from grainlaw.materials.element.specimen import prepared

    chosen = chosen_test(test, control)
    _check_outputs(out, plot, material)
    prepared_tests = []
    for entry in material:
        name, _, set_name = entry.partition(":")
        prepared_tests.append(prepared(name, set_name or parameters, values, chosen))
    results = []
    for specimen, settings in prepared_tests:
        start = time.perf_counter()
        results.append(run_element_test(chosen, specimen, settings))
        _print_result(chosen, results[-1], time.perf_counter() - start)
        # After the test, so that one that fails is one line.
        specimen.warn_about_density(settings.initial_pressure, settings.density)
    if out:
        results[0].write_csv(out)
        typer.echo(f"wrote {out}")
    if plot:
        from grainlaw.materials.element.figures import draw

        draw(results, plot)
        typer.echo(f"wrote {plot}")


def _check_outputs(out: Path | None, plot: Path | None, materials: list[str]) -> None:
    """Refuse before the computation what could not be written after it."""
    if out and len(materials) > 1:
        raise InputError(f"--out takes one material, not {len(materials)}: {', '.join(materials)}")
    for path, suffix in ((out, ".csv"), (plot, ".png")):
        if path and path.suffix != suffix:
            raise InputError(f"{path} does not end in {suffix}")
        if path and not path.parent.is_dir():
            raise InputError(f"{path}: there is no folder {path.parent}")


def _print_result(test: "ElementTest", result: "ElementResult", wall_time: float) -> None:
    law = result.specimen.law
    declared = {**test.setting_declarations, **law.parameter_declarations}
    values = {**result.settings._asdict(), "density": result.density[0], **result.specimen.parameters._asdict()}
    typer.echo(f"{result.test}: {law.name}, parameters: {result.specimen.source}")
    for name, value in values.items():
        typer.echo(f"  {name} = {_with_unit(value, declared[name].unit)}")
    typer.echo(f"after {result.steps} steps ({wall_time:.2f} s, compilation included):")
    for column in result.columns:
        if not column.name.startswith(("stress_", "strain_")):
            value = column.values[-1]
            shown = "not defined, nothing flows" if math.isnan(value) else _with_unit(value, column.unit)
            typer.echo(f"  {column.name} = {shown}")
    if result.pressure[-1] > 0.0:
        typer.echo(f"  q/p = {result.deviatoric_stress[-1] / result.pressure[-1]:.6g}")


def _with_unit(value: float, unit: str) -> str:
    return f"{value:.9g}" if unit == "1" else f"{value:.9g} {unit}"
