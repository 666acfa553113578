"""The keys of a scene file, from the models that validate it."""

import re
import types
import typing
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from grainlaw.materials.declarations import BASE_UNITS
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.reference.markdown import code, table

_FACTOR = rf"(?:{'|'.join(BASE_UNITS)})\d*"
_UNIT = re.compile(rf"\s*\[({_FACTOR}(?:[./]{_FACTOR})*)\]")
_TYPE_NAMES = {float: "number", int: "whole number", str: "text", bool: "true or false", Path: "path"}
_LIMITS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


@dataclass
class SceneTable:
    """One model of the scene, and the places in a scene file where it stands."""

    model: type[BaseModel]
    places: list[str] = field(default_factory=list)


def scene_tables() -> list[SceneTable]:
    """The models behind a scene, outermost first."""
    found: dict[type[BaseModel], SceneTable] = {}
    _collect(Scene, "", found)
    return list(found.values())


def scene_reference() -> str:
    """Every key of a scene file in tables, one for each model."""
    parts = []
    for entry in scene_tables():
        parts += [f"### {_heading(entry)}\n", f"{entry.model.__doc__}\n"]
        rows = [_row(name, info) for name, info in entry.model.model_fields.items()]
        parts.append(table(["key", "type", "unit", "default", "meaning"], rows))
    return "\n".join(parts)


def split_unit(description: str) -> tuple[str, str]:
    """A description without the unit that it names in brackets, and that unit."""
    unit = _UNIT.search(description)
    return _UNIT.sub("", description, count=1), unit[1] if unit else ""


def models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """The models that an annotation mentions."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in typing.get_args(annotation):
        yield from models_in(argument)


def _collect(model: type[BaseModel], place: str, found: dict[type[BaseModel], SceneTable]) -> None:
    found.setdefault(model, SceneTable(model)).places.append(place)
    for name, info in model.model_fields.items():
        inner = f"{place}.{name}".strip(".")
        for part in models_in(info.annotation):
            _collect(part, inner, found)


def _heading(entry: SceneTable) -> str:
    if entry.places == [""]:
        return "Top level"
    heading = ", ".join(code(place) for place in entry.places)
    kinds = entry.model.model_fields.get("kind")
    options = typing.get_args(kinds.annotation) if kinds else ()
    return f'{heading} with `kind = "{options[0]}"`' if len(options) == 1 else heading


def _row(name: str, info: FieldInfo) -> list[str]:
    meaning, unit = split_unit(description(info))
    limits = ", ".join(
        f"{sign} {getattr(item, limit):g}"
        for item in info.metadata
        for limit, sign in _LIMITS.items()
        if getattr(item, limit, None) is not None
    )
    kind = " ".join(part for part in (_type_name(info.annotation), limits) if part)
    return [code(name), kind, unit, _default(info), meaning]


def description(info: FieldInfo) -> str:
    """What a key means: its own description or, for a table, the first line about its model."""
    inner = list(models_in(info.annotation))
    return info.description or (inner[0].__doc__ or "" if len(inner) == 1 else "")


def _type_name(annotation: Any) -> str:
    if annotation in _TYPE_NAMES:
        return _TYPE_NAMES[annotation]
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is Literal:
        return ", ".join(code(_toml(value)) for value in arguments)
    names = ["..." if part is ... else _type_name(part) for part in arguments if part is not type(None)]
    if origin is tuple:
        return f"[{', '.join(names)}]"
    if origin is list:
        return f"[{names[0]}, ...]"
    if origin in (typing.Union, types.UnionType):
        return " or ".join(dict.fromkeys(names))
    return "table"


def _default(info: FieldInfo) -> str:
    if info.is_required():
        return "required"
    value = info.get_default(call_default_factory=True)
    if value is None:
        return ""
    if isinstance(value, BaseModel):
        given = {name: getattr(value, name) for name in sorted(value.model_fields_set)}
        return ", ".join(code(f"{name} = {_toml(part)}") for name, part in given.items()) or "its defaults"
    return code(_toml(value))


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, tuple | list):
        return f"[{', '.join(_toml(part) for part in value)}]"
    return f"{value:g}"
