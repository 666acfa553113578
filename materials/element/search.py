"""Finding the root of a growing scalar function, one evaluation at a time, in plain and in compiled code."""

import math
from typing import NamedTuple

# Of x, by which its bracket is too narrow to be halved in earnest.
ROUND_OFF = 1e-15


class Search(NamedTuple):
    """The search for a root: the next x to try, and what is known from the previous ones."""

    x: float
    slope: float
    lower: float
    upper: float
    expansion: float
    previous_x: float
    previous_residual: float


def search_from(x: float, slope: float, expansion: float) -> Search:
    """A search that starts at x with a first estimate of the slope (0 if there is none) and a first distance to try."""
    return Search(x, slope, -math.inf, math.inf, expansion, math.nan, math.nan)


def narrowed(search: Search, residual: float) -> Search:
    """The search after the residual at search.x: by secant where that helps, else by bisection or by a longer reach."""
    x, slope, expansion = search.x, search.slope, search.expansion
    if math.isnan(residual):
        # Too far out for the function: go half of the way back.
        halfway = 0.5 * (x + search.previous_x)
        return Search(
            halfway, slope, search.lower, search.upper, 0.25 * expansion, search.previous_x, search.previous_residual
        )
    lower = x if residual < 0.0 else search.lower
    upper = x if residual > 0.0 else search.upper
    stalled = abs(residual) > 0.5 * abs(search.previous_residual)
    if not math.isnan(search.previous_x) and x != search.previous_x and residual != search.previous_residual:
        slope = (residual - search.previous_residual) / (x - search.previous_x)
    proposed = x - residual / slope if slope > 0.0 else math.nan
    if math.isfinite(lower) and math.isfinite(upper):
        if stalled or not lower < proposed < upper:
            proposed = 0.5 * (lower + upper)
    elif abs(residual) >= abs(search.previous_residual) or not abs(proposed - x) <= expansion:
        proposed = x + expansion if residual < 0.0 else x - expansion
        expansion *= 4.0
    return Search(proposed, slope, lower, upper, expansion, x, residual)


def is_shut(search: Search, size: float) -> bool:
    """Whether there is nothing left between lower and upper; `size` is that of quantities to which x is added."""
    return search.upper - search.lower <= ROUND_OFF * (abs(search.x) + size)
