"""Open sides of the domain: no wall is there, and points that have gone through are gone.

They are removed at the next sort. Until then a point has drifted by less than `sorting.LONGEST_DRIFT`, so that its
stencil stays within the nodes beyond the side (`grid.GHOSTS`).
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.grid import GHOSTS, Grid
from grainlaw.mpm_core.kernels.elastic_energy import elastic_energy
from grainlaw.mpm_core.kernels.shape_functions import Basis

Floats = NDArray[np.float64]


class Departed(NamedTuple):
    """What points took with them, in the amounts of the space.

    mass       [kg]
    kinetic    energy, in the middle of the last step [J]
    potential  energy of gravity at the end of the last step, over the lower corner of the domain [J]
    risen      what of it they gained in the last step [J]
    elastic    energy; NaN if a law does not state it [J]
    """

    mass: float
    kinetic: float
    potential: float
    risen: float
    elastic: float


def let_leave(
    bodies: Sequence[Body], grid: Grid, basis: Basis, gravity: Sequence[float], last_step: float
) -> Departed | None:
    """Remove the points beyond open sides after a step [s]; returns what they took with them, None if there were none.

    Stencils and contacts of the others have to be found again.
    """
    if not any(map(any, grid.open_sides)):
        return None
    found = []
    for body in bodies:
        gone = _beyond(body, grid)
        if gone.any():
            found.append(_taken(body, gone, grid, basis, np.array(gravity), last_step))
            body.remove(gone)
    return Departed(*map(sum, zip(*found, strict=True))) if found else None


def _beyond(body: Body, grid: Grid) -> NDArray[np.bool_]:
    gone = np.zeros(body.count, np.bool_)
    for axis, (below, above) in enumerate(grid.open_sides):
        if below:
            gone |= body.positions[axis] < grid.lower[axis]
        if above:
            gone |= body.positions[axis] > grid.upper[axis]
    return gone


def _taken(
    body: Body, gone: NDArray[np.bool_], grid: Grid, basis: Basis, gravity: Floats, last_step: float
) -> Departed:
    masses, velocity = body.masses[gone], body.velocity[:, gone].astype(np.float64)
    affine = body.affine[:, :, gone].astype(np.float64)
    above = body.positions[:, gone] - np.array(grid.lower)[:, np.newaxis]
    moments = grid.cell_size**2 * _moments(above / grid.cell_size + GHOSTS, basis)
    squares = (velocity**2).sum(axis=0) + ((affine**2).sum(axis=0) * moments).sum(axis=0)
    return Departed(
        mass=float(masses.sum()),
        kinetic=0.5 * float((masses * squares).sum()),
        potential=-float((masses * (gravity @ above)).sum()),
        risen=-last_step * float((masses * (gravity @ velocity)).sum()),
        elastic=elastic_energy(body, np.ascontiguousarray(body.points[:, gone])),
    )


def _moments(places: Floats, basis: Basis) -> Floats:
    """The second moment of the shape functions along each axis at places [cells], in squares of the cell size."""
    moment: Any = basis.moment
    return np.asarray(moment(places - np.trunc(places - basis.offset)) + np.zeros_like(places))
