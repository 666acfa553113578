"""Options that several commands share."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from grainlaw.materials import InputError, SimulationError, registry

PluginFiles = Annotated[
    list[Path] | None, typer.Option("--plugin", metavar="FILE.py", help="Also load the laws of this file; repeatable.")
]


def load_plugins(files: list[Path] | None) -> None:
    """Register the laws of single files. Raises InputError if one of them is refused."""
    for path in files or []:
        registry().load_file(path)


def assigned(assignments: list[str] | None, option: str = "--set") -> dict[str, str]:
    """`name=value` texts as a dictionary. Raises InputError for a text without '=' and for a name given twice."""
    values: dict[str, str] = {}
    for text in assignments or []:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise InputError(f"{option} {text}: expected name=value")
        if name in values:
            raise InputError(f"{option} {name} is given twice: {values[name]} and {value}")
        values[name] = value
    return values


def numbers(values: dict[str, str], option: str = "--set") -> dict[str, float]:
    """The values as numbers. Raises InputError for a text that is none."""
    found = {}
    for name, text in values.items():
        try:
            found[name] = float(text)
        except ValueError:
            raise InputError(f"{option} {name}={text}: '{text}' is not a number") from None
    return found


@contextmanager
def stops_told(without_note: str = "stopped by Ctrl-C") -> Iterator[None]:
    """Turn Ctrl-C into a SimulationError that says what the interrupt notes of how to go on."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        raise SimulationError(getattr(interrupt, "__notes__", [without_note])[-1]) from interrupt


def counted(number: int, name: str) -> str:
    """A number of things, of which one is called `name`."""
    return f"{number} {name}{'' if number == 1 else 's'}"
