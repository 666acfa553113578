"""Open sides of the domain: no wall is there, and points that have gone through are gone.

They are removed at the next sort. Until then a point has drifted by less than `sorting.LONGEST_DRIFT`, so that its
stencil stays within the nodes beyond the side (`grid.GHOSTS`).
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.carried import Carried, all_carried, carried_by
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.kernels.shape_functions import Basis


def let_leave(
    bodies: Sequence[Body], grid: Grid, basis: Basis, gravity: Sequence[float], last_step: float
) -> Carried | None:
    """Remove the points beyond open sides after a step [s]; returns what they took with them, None if there were none.

    Stencils and contacts of the others have to be found again.
    """
    if not any(map(any, grid.open_sides)):
        return None
    found = []
    for body in bodies:
        gone = _beyond(body, grid)
        if gone.any():
            found.append(carried_by(body, gone, grid, basis, gravity, last_step))
            body.remove(gone)
    return all_carried(found)


def _beyond(body: Body, grid: Grid) -> NDArray[np.bool_]:
    gone = np.zeros(body.count, np.bool_)
    for axis, (below, above) in enumerate(grid.open_sides):
        if below:
            gone |= body.positions[axis] < grid.lower[axis]
        if above:
            gone |= body.positions[axis] > grid.upper[axis]
    return gone
