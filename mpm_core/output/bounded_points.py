"""What is bounded instead of clipped, counted: a user has to be able to see it.

- points without stress, which open and close freely (`stress`: points without contact),
- points nearer to a wall than a twentieth of a cell, whose stiffness is bounded (`basis`),
- points that their law holds at a bound of its own (`Law.lower_bounds`), such as Cam Clay's smallest yield surface,
- faces of cells, since the start, across which volume projection would have moved points by more than a quarter of a
  cell at once.

Everything else that goes wrong stops a run.
"""

import numpy as np

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.kernels.shape_functions import SMALLEST_MOMENT_AT_WALL
from grainlaw.mpm_core.simulation import Simulation


def limited(simulation: Simulation) -> dict[str, int]:
    """Numbers of points for which something is bounded now, and of faces for which it was, by what it is."""
    return {
        "points_without_stress": sum(_without_stress(body) for body in simulation.bodies),
        "points_at_a_wall": sum(_at_walls(simulation, body) for body in simulation.bodies),
        "points_at_a_bound_of_their_law": sum(_at_bounds(body) for body in simulation.bodies),
        "long_ways_of_volume_projection": simulation.ways_bounded,
    }


def _without_stress(body: Body) -> int:
    return int((body.stress[:3] == 0.0).all(axis=0).sum())


def _at_walls(simulation: Simulation, body: Body) -> int:
    grid, near = simulation.grid, np.zeros(body.count, np.bool_)
    for coordinate, (lower, upper) in zip(body.positions, grid.limits, strict=True):
        near |= np.minimum(coordinate - lower, upper - coordinate) < SMALLEST_MOMENT_AT_WALL * grid.cell_size
    return int(near.sum())


def _at_bounds(body: Body) -> int:
    at_bound = np.zeros(body.count, np.bool_)
    for name, smallest in body.law.lower_bounds.items():
        values = body.states[body.law.state._fields.index(name)]
        at_bound |= values <= values.dtype.type(smallest(body.parameters))
    return int(at_bound.sum())
