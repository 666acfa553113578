"""Numbers as few bytes, and bytes as text."""

from base64 import b64encode
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
# Of places along an axis, and of values between the ends of their colours.
STEPS, LEVELS = 65_535, 255
# In the place of a value that is not finite.
NO_VALUE = 255


def as_text(numbers: NDArray[Any]) -> str:
    """The bytes of an array, the lowest of each number first, in base 64."""
    return b64encode(numbers.astype(numbers.dtype.newbyteorder("<")).tobytes()).decode("ascii")


def packed_places(places: Sequence[Floats], lower: Floats, upper: Floats) -> str:
    """Places of points, each of shape (n, axes) [m], as 16 bits for each coordinate between two corners."""
    extent = np.where(upper > lower, upper - lower, 1.0)
    shares = np.concatenate([(some - lower) / extent for some in places])
    return as_text(np.rint(STEPS * shares).clip(0, STEPS).astype(np.uint16))


def packed_values(values: Sequence[Floats], lower: float, upper: float) -> str:
    """Values, each of shape (n,), as the numbers of their colours, the ends for what lies beyond them."""
    all_values = np.concatenate(values)
    is_finite = np.isfinite(all_values)
    shares = (np.where(is_finite, all_values, lower) - lower) / (upper - lower)
    levels = np.rint((LEVELS - 1) * shares).clip(0, LEVELS - 1)
    return as_text(np.where(is_finite, levels, NO_VALUE).astype(np.uint8))
