"""What a sweep varies: a key of the scene over a range or over given values."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from grainlaw.materials import InputError
from grainlaw.mpm_core.scene.file import value_of_text

FORMS = "expected KEY=a:b:n, KEY=a:b (with samples) or KEY=[v1,v2]"
_RANGE = re.compile(r"([^:\[\]]+):([^:]+)(?::([^:]+))?")
# More values of one key are a slip.
MOST_VALUES = 10_000

Given = str | Sequence[Any]
"""What a key is varied over: "a:b:n", "a:b", "[v1,v2]", or a list of values."""


@dataclass(frozen=True)
class Variation:
    """A key of the scene by dotted name, its values, and what was asked for, for messages.

    `levels` are the values of a grid, none for a range a:b; `bounds` are those of a range, None for given values.
    """

    key: str
    levels: tuple[Any, ...]
    bounds: tuple[float, float] | None
    text: str

    @property
    def ends(self) -> tuple[Any, ...]:
        """The values that are checked before anything is run: those given, or the ends of the range."""
        if not self.levels:
            return self.bounds or ()
        return self.levels if self.bounds is None else (self.levels[0], self.levels[-1])

    def at(self, share: float) -> Any:
        """The value at a share of the range, or among the given values, from 0 to 1."""
        if self.bounds is None:
            return self.levels[min(int(share * len(self.levels)), len(self.levels) - 1)]
        low, high = self.bounds
        return low + share * (high - low)


def variations_of(vary: Mapping[str, Given]) -> tuple[Variation, ...]:
    """What keys are varied over. Raises InputError in one line for a text of no known form and for an empty range."""
    return tuple(_variation(key, given) for key, given in vary.items())


def _variation(key: str, given: Given) -> Variation:
    if not isinstance(given, str):
        return _of_values(key, list(given), f"{key}={list(given)}")
    text = given.strip()
    if text.startswith("[") and text.endswith("]"):
        return _of_values(key, _listed(text), f"{key}={text}")
    found = _RANGE.fullmatch(text)
    if found is None:
        raise InputError(f"--vary {key}={text}: {FORMS}")
    return _of_range(key, text, *(part and part.strip() for part in found.groups()))


def _listed(text: str) -> list[Any]:
    """The entries of a list of TOML; of names without quotes, too."""
    value = value_of_text(text)
    if isinstance(value, list):
        return value
    entries = text[1:-1].strip()
    return [value_of_text(entry.strip()) for entry in entries.split(",")] if entries else []


def _of_values(key: str, values: list[Any], text: str) -> Variation:
    if not values:
        raise InputError(f"--vary {text}: no value; {FORMS}")
    if len(values) > MOST_VALUES:
        raise InputError(f"--vary {key}: {len(values)} values; allowed: {MOST_VALUES} or fewer")
    if any(values[i] == values[j] for i in range(len(values)) for j in range(i)):
        raise InputError(f"--vary {text}: a value stands there twice")
    return Variation(key, tuple(values), None, text)


def _of_range(key: str, text: str, low_text: str, high_text: str, count_text: str | None) -> Variation:
    asked = f"--vary {key}={text}"
    low, high = (_number(asked, part) for part in (low_text, high_text))
    if not low < high:
        raise InputError(f"{asked}: the range is empty; allowed: a < b")
    if count_text is None:
        return Variation(key, (), (low, high), f"{key}={text}")
    count = _count(asked, count_text)
    levels = np.linspace(low, high, count).tolist()
    # Keys that take whole numbers only refuse 4.0.
    if all(isinstance(value_of_text(part), int) for part in (low_text, high_text)) and all(map(_is_whole, levels)):
        levels = [round(level) for level in levels]
    return Variation(key, tuple(levels), (low, high), f"{key}={text}")


def _number(asked: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise InputError(f"{asked}: '{text}' is not a number; {FORMS}")
    return number


def _count(asked: str, text: str) -> int:
    if not text.isdecimal() or not 2 <= int(text) <= MOST_VALUES:
        raise InputError(f"{asked}: {text} values; allowed: 2 to {MOST_VALUES}")
    return int(text)


def _is_whole(number: float) -> bool:
    return number == round(number)
