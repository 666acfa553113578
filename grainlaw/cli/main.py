"""The command `grainlaw`: the sub-commands, and the exit codes (0 done, 2 bad input, 1 anything else)."""

import io
import sys
import warnings
from functools import cache
from importlib.metadata import version
from typing import Annotated, TextIO

import typer

from grainlaw.cli.calibrate_command import calibrate
from grainlaw.cli.check_command import check
from grainlaw.cli.compare_command import compare
from grainlaw.cli.dem_command import dem
from grainlaw.cli.element_command import element
from grainlaw.cli.materials_command import materials
from grainlaw.cli.movie_command import movie
from grainlaw.cli.new_law_command import new_law
from grainlaw.cli.plan_command import plan
from grainlaw.cli.predict_command import predict
from grainlaw.cli.report_command import report
from grainlaw.cli.run_command import run
from grainlaw.cli.scenes_command import scenes
from grainlaw.cli.sweep_command import sweep
from grainlaw.cli.validate_command import validate
from grainlaw.cli.view_command import view
from grainlaw.materials import InputError, SimulationError
from grainlaw.materials.errors import InputWarning

app = typer.Typer(
    help="Constitutive laws for granular matter: list them, test them on one point, run them in a scene.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

# A command's module imports what it needs inside its function, so that no command pays for another's libraries.
app.command("materials")(materials)
app.command("element")(element)
app.command("calibrate")(calibrate)
app.command("scenes")(scenes)
app.command("run")(run)
app.command("plan")(plan)
app.command("sweep")(sweep)
app.command("predict")(predict)
app.command("compare")(compare)
app.command("movie")(movie)
app.command("view")(view)
app.command("validate")(validate)
app.command("report")(report)
app.command("new-law")(new_law)
app.command("check")(check)
app.add_typer(dem, name="dem")


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"grainlaw {version('grainlaw')}")
        raise typer.Exit()


@app.callback()
def _options(
    show_version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and leave.")
    ] = False,
) -> None:
    """Take the options that come before any command."""


def main() -> None:
    """Run the command line: bad input is one line on stderr and exit code 2, a failed computation exit code 1."""
    _escape_what_the_terminal_lacks()
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _show_warning
            app()
    except InputError as error:
        _fail(str(error), 2)
    except SimulationError as error:
        _fail(str(error), 1)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        _fail(f"{where}{error.strerror or error}", 1)


def _escape_what_the_terminal_lacks() -> None:
    """Write characters outside the encoding of the output, of a path or a unit, as escapes instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _show_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """What is said about the request in one line, once; anything else as Python does."""
    if issubclass(category, InputWarning):
        _warn_once(str(message))
    else:
        (file or sys.stderr).write(warnings.formatwarning(message, category, filename, lineno, line))


@cache
def _warn_once(message: str) -> None:
    typer.echo(f"warning: {message}", err=True)


def _fail(message: str, code: int) -> None:
    typer.echo(f"error: {message}", err=True)
    sys.exit(code)
