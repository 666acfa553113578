"""Faults that pydantic finds in a file, in words: key, value, what is allowed."""

import re
from collections.abc import Mapping
from typing import Any

from grainlaw.materials.errors import nearest_name

_ALLOWED = {
    "greater_than": "> {gt:g}",
    "greater_than_equal": ">= {ge:g}",
    "less_than": "< {lt:g}",
    "less_than_equal": "<= {le:g}",
    "finite_number": "a finite number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "too_short": "{min_length} or more entries",
    "too_long": "{max_length} or fewer entries",
    "literal_error": "{expected}",
    "path_type": "the name of a file",
}
# By the first word of the type: what was given is of another kind altogether.
_KINDS = {
    "float": "a number",
    "int": "a whole number",
    "string": "a text",
    "bool": "true or false",
    "list": "a list",
    "tuple": "a list",
    "dict": "a table",
    "model": "a table",
    "mapping": "a table",
}
_LONGEST_VALUE = 60
_OWN_WORDS = "Value error, "


def fault_in_words(fault: Mapping[str, Any], key: str) -> str:
    """One entry of `ValidationError.errors()`; `key` is where it stands, empty for the file itself."""
    kind, value = fault["type"], fault["input"]
    if kind == "missing":
        listed, _, entry = key.rpartition(".")
        return f"{listed} = {_shown(value)}: entry {entry} is missing" if entry.isdecimal() else f"'{key}' is missing"
    if kind == "value_error":
        message = fault["msg"].removeprefix(_OWN_WORDS)
        return f"{key}: {message}" if key else message
    if kind == "literal_error" and isinstance(value, str):
        return not_among(key, value, fault["ctx"]["expected"])
    allowed = _ALLOWED.get(kind) or _KINDS.get(kind.partition("_")[0])
    reason = f"allowed: {allowed.format(**fault.get('ctx', {}))}" if allowed else fault["msg"]
    return f"{key} = {_shown(value)}: {reason}" if key else reason


def not_among(key: str, value: str, allowed: str) -> str:
    """What is wrong with a text that is none of some quoted ones."""
    close = nearest_name(value, re.findall("'([^']*)'", allowed))
    hint = f"; {close}" if close.startswith("did") else ""
    return f"{key} = {value!r}: allowed: {allowed}{hint}"


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= _LONGEST_VALUE else f"{text[:_LONGEST_VALUE]}..."
