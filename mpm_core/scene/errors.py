"""Validation errors of a scene in one line: key, value, what is allowed, the nearest valid name."""

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ValidationError

from grainlaw.materials.errors import nearest_name
from grainlaw.materials.faults import fault_in_words, not_among

# Beyond these, the rest is counted.
MOST_DESCRIBED = 5
_RANKS = {"extra_forbidden": 0, "missing": 2}


def described(error: ValidationError, model: type[BaseModel], content: Mapping[str, Any]) -> str:
    """The problems of a validation error in one line; unknown keys first, which may be why others are missing."""
    problems = sorted(error.errors(), key=lambda found: _RANKS.get(found["type"], 1))
    shown = [_sentence(problem, _key(problem, content), model) for problem in problems[:MOST_DESCRIBED]]
    more = len(problems) - len(shown)
    return "; also ".join(shown) + (f" (and {more} more)" if more else "")


def _key(problem: Any, content: Mapping[str, Any]) -> str:
    # The discriminator of a union appears in the location but is no key of the file.
    tags = _union_tags(problem, content)
    return ".".join(str(part) for part in problem["loc"] if not (isinstance(part, str) and part in tags))


def _sentence(problem: Any, key: str, model: type[BaseModel]) -> str:
    kind = problem["type"]
    if kind == "extra_forbidden":
        *parents, name = key.split(".")
        return f"unknown key '{key}'; {nearest_name(name, _keys(model, parents))}"
    if kind == "union_tag_not_found":
        tag = problem["ctx"]["discriminator"].strip("'")
        return f"'{key}.{tag}' is missing"
    if kind == "union_tag_invalid":
        tag = problem["ctx"]["discriminator"].strip("'")
        return not_among(f"{key}.{tag}", problem["ctx"]["tag"], problem["ctx"]["expected_tags"])
    return fault_in_words(problem, key)


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
