"""What numbers are stored as and computed with."""

from typing import Any

import numpy as np

PRECISIONS: dict[str, Any] = {"double": np.float64, "single": np.float32}


def as_numbers(value: Any, number: Any) -> Any:
    """A number, or a NamedTuple of numbers, as numbers of a kind."""
    if not isinstance(value, tuple):
        return number(value)
    kind: Any = type(value)
    return kind(*map(number, value))
