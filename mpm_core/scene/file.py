"""Reading a scene file: TOML, files that it names, values set on top of it; paths count from the file."""

import tomllib
from collections.abc import Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any

from grainlaw.materials import InputError
from grainlaw.materials.calibration.parameter_values import read_values


def read_content(path: Path, overrides: Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a TOML file with the parameter files that it names, and with values by dotted key set on top.

    Raises InputError for a file that cannot be read and for a key that leads nowhere.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not valid TOML: {error}") from None
    content = with_values(content, overrides)
    materials = content.get("material")
    for table in materials.values() if isinstance(materials, dict) else ():
        _take_in_parameter_file(table, path)
    for key, table in (("body", "shape"), ("obstacle", "shape"), ("obstacle", "motion")):
        entries = content.get(key)
        for entry in entries if isinstance(entries, list) else ():
            _resolve_file(entry.get(table) if isinstance(entry, dict) else None, path.parent)
    return content


def with_values(content: Mapping[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    """A copy of a scene's tables with values by dotted key set on top. Raises InputError for a key that leads nowhere.

    Entries of lists go by number: `body.0.density`.
    """
    changed = deepcopy(dict(content))
    for key, value in overrides.items():
        _set_dotted(changed, key, value)
    return changed


def value_of_text(text: str) -> Any:
    """A value as TOML would read it; what is no TOML value is a string."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _take_in_parameter_file(table: Any, scene: Path) -> None:
    """Complete a table of material constants by the TOML file that its key `parameters` names, if it has one."""
    name = table.pop("parameters", None) if isinstance(table, dict) else None
    if name is None:
        return
    file = scene.parent / str(name)
    try:
        values = read_values(file)
    except InputError as error:
        raise InputError(f"{scene}: {error}") from None
    for key, value in values.items():
        table.setdefault(key, value)


def _set_dotted(content: dict[str, Any], key: str, value: Any) -> None:
    *parents, last = key.split(".")
    table: Any = content
    for name in parents:
        table = table[_entry(table, key, name)] if isinstance(table, list) else table.setdefault(name, {})
        if not isinstance(table, dict | list):
            raise InputError(f"--set {key}: '{name}' is a value, not a table")
    table[_entry(table, key, last) if isinstance(table, list) else last] = value


def _entry(entries: list[Any], key: str, name: str) -> int:
    if not (name.isdecimal() and int(name) < len(entries)):
        raise InputError(f"--set {key}: '{name}' is no entry of the list; allowed: 0 to {len(entries) - 1}")
    return int(name)


def _resolve_file(table: Any, folder: Path) -> None:
    if isinstance(table, dict) and isinstance(table.get("file"), str):
        # Absolute, so that the copy of the scene in the run's folder finds it too.
        table["file"] = str((folder / table["file"]).absolute())
