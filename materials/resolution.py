"""How finely a law has to be resolved for a stated accuracy: a statement that a law may make, from measurement."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Resolution:
    """What kept runout, height and centre of mass of column collapses within an accuracy of finer grids.

    cells_across     cells across the narrowest body, at least
    points_per_cell  material points per cell
    safety           fraction of the critical time step
    cells_along      cells along the edge of a square as large as the smallest body, at least
    slenderness      height over width of a body, at most
    """

    cells_across: int
    points_per_cell: int
    safety: float
    cells_along: int = 1
    slenderness: float = math.inf
