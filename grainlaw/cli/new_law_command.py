"""`grainlaw new-law`: a package of its own for a new law."""

import keyword
import re
import sys
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from grainlaw.materials import InputError, registry

TEMPLATE_NAME = "coulomb_example"
WRITTEN = (".py", ".toml", ".md")


def new_law(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the law, in lower_case_with_underscores.")],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="Folder to write; default: the name, with hyphens.", show_default=False
        ),
    ] = None,
) -> None:
    """Write a package with a law to complete, its test (which fails until you have), and a scene for it."""
    _check_name(name)
    folder = out or Path(name.replace("_", "-"))
    if folder.exists():
        raise InputError(f"{folder} exists already; choose another folder with --out")
    contents = {
        file.name.replace(TEMPLATE_NAME, name): _renamed(file.read_text(encoding="utf-8"), name)
        for file in files("grainlaw.plugins").joinpath("template").iterdir()
        if file.name.endswith(WRITTEN)
    }
    try:
        folder.mkdir(parents=True)
        for file_name, text in contents.items():
            (folder / file_name).write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{folder} cannot be written: {error.strerror}") from None
    for file_name in sorted(contents):
        typer.echo(f"  {folder / file_name}")
    typer.echo(f"next: cd {folder}; pip install -e .; python -m pytest test_{name}.py; grainlaw check {name}")


def _check_name(name: str) -> None:
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name) or keyword.iskeyword(name):
        raise InputError(f"'{name}' is no name for a law; allowed: lower_case_with_underscores, such as cemented_sand")
    if name in registry().laws:
        raise InputError(f"the name '{name}' is taken by {registry().laws[name].origin}")
    installed = find_spec(name)
    # A folder without Python files is found too, but has no origin: it may be the one that another try made.
    if name in sys.stdlib_module_names or (installed is not None and installed.origin is not None):
        raise InputError(f"the name '{name}' is that of another Python module; choose one of your own")


def _renamed(text: str, name: str) -> str:
    return text.replace(TEMPLATE_NAME, name).replace(TEMPLATE_NAME.replace("_", "-"), name.replace("_", "-"))
