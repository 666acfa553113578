"""Validation errors of a scene in one line: key, value, what is allowed, the nearest valid name."""

import re
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ValidationError

from grainlaw.materials.errors import nearest_name


def described(error: ValidationError, model: type[BaseModel], content: Mapping[str, Any]) -> str:
    """The first problem of a validation error, and how many more there are."""
    problems = error.errors()
    first = problems[0]
    # The discriminator of a union appears in the location but is no key of the file.
    location = [part for part in first["loc"] if not (isinstance(part, str) and part in _union_tags(first, content))]
    key = ".".join(str(part) for part in location)
    text = _sentence(first, key, model)
    more = len(problems) - 1
    return text + (f" (and {more} more)" if more else "")


def _sentence(problem: Any, key: str, model: type[BaseModel]) -> str:
    kind = problem["type"]
    if kind == "extra_forbidden":
        *parents, name = key.split(".")
        return f"unknown key '{key}'; {nearest_name(name, _keys(model, parents))}"
    if kind == "missing":
        return f"'{key}' is missing"
    if kind == "union_tag_invalid":
        tag = problem["ctx"]["discriminator"].strip("'")
        return _not_among(f"{key}.{tag}", problem["ctx"]["tag"], problem["ctx"]["expected_tags"])
    if kind == "literal_error" and isinstance(problem["input"], str):
        return _not_among(key, problem["input"], problem["ctx"]["expected"])
    message = problem["msg"].removeprefix("Value error, ")
    if kind == "value_error":
        return f"{key}: {message}" if key else message
    return f"{key} = {problem['input']!r}: {message}"


def _not_among(key: str, value: str, allowed: str) -> str:
    """What is wrong with a text that is none of some quoted ones."""
    close = nearest_name(value, re.findall("'([^']*)'", allowed))
    hint = f"; {close}" if close.startswith("did") else ""
    return f"{key} = {value!r}: allowed: {allowed}{hint}"


def _union_tags(problem: Any, content: Mapping[str, Any]) -> set[str]:
    tags = set()
    value: Any = content
    for part in problem["loc"]:
        if isinstance(value, Mapping):
            if part not in value and value.get("kind") == part:
                tags.add(part)
                continue
            value = value.get(part)
        elif isinstance(value, list) and isinstance(part, int) and part < len(value):
            value = value[part]
    return tags


def _keys(model: type[BaseModel], parents: list[str]) -> set[str]:
    """The keys that a table of the scene may have; empty where the location is no fixed table."""
    current: Any = model
    for name in parents:
        if name.isdigit():
            continue
        field = current.model_fields.get(name) if hasattr(current, "model_fields") else None
        if field is None:
            return set()
        current = _model_of(field.annotation)
    return set(current.model_fields) if hasattr(current, "model_fields") else set()


def _model_of(annotation: Any) -> Any:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for part in getattr(annotation, "__args__", ()):
        found = _model_of(part)
        if found is not None:
            return found
    return None
