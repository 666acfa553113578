"""What is bounded instead of clipped, counted: a user has to be able to see it.

- points without stress, which open and close freely (`stress`: points without contact),
- points nearer to a wall than a twentieth of a cell, whose stiffness is bounded (`basis`),
- points that their law holds at a bound of its own (`Law.at_bound`), as Cam Clay does with its smallest yield surface.

Everything else that goes wrong stops a run.
"""

import numpy as np

from grainlaw.materials.tensor import SymmetricTensor
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.kernels.shape_functions import SMALLEST_MOMENT_AT_WALL
from grainlaw.mpm_core.layout import DENSITY, SXX, SXY, SYY, SZZ, X, Y
from grainlaw.mpm_core.simulation import Simulation


def limited(simulation: Simulation) -> dict[str, int]:
    """Numbers of points for which something is bounded now, by what it is."""
    return {
        "points_without_stress": sum(_without_stress(body) for body in simulation.bodies),
        "points_at_a_wall": sum(_at_walls(simulation, body) for body in simulation.bodies),
        "points_at_a_bound_of_their_law": sum(_at_bounds(body) for body in simulation.bodies),
    }


def _without_stress(body: Body) -> int:
    return int(((body.stress[0] == 0.0) & (body.stress[1] == 0.0)).sum())


def _at_walls(simulation: Simulation, body: Body) -> int:
    grid, near = simulation.grid, np.zeros(body.count, np.bool_)
    for axis, row in ((0, X), (1, Y)):
        if axis not in simulation.periodic_axes:
            distance = np.minimum(body.points[row] - grid.lower[axis], grid.upper[axis] - body.points[row])
            near |= distance < SMALLEST_MOMENT_AT_WALL * grid.cell_size
    return int(near.sum())


def _at_bounds(body: Body) -> int:
    """In plain Python: it is asked for once in a run."""
    law = body.law
    if law.at_bound is None:
        return 0
    rows = np.vstack([body.points[[SXX, SYY, SZZ, SXY, DENSITY]], body.states])
    return sum(
        law.at_bound(SymmetricTensor(xx, yy, zz, xy, 0.0, 0.0), density, law.state(*state), body.parameters)
        for xx, yy, zz, xy, density, *state in rows.T.tolist()
    )
