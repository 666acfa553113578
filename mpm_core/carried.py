"""What points carry over the edge of what is counted: where they leave through open sides, or enter through mouths."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.grid import GHOSTS, Grid
from grainlaw.mpm_core.kernels.elastic_energy import elastic_energy
from grainlaw.mpm_core.kernels.shape_functions import Basis

Floats = NDArray[np.float64]


class Carried(NamedTuple):
    """What points carry, in the amounts of the space.

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

    @property
    def potential_in_the_middle(self) -> float:
        """That in the middle of the last step, where the other energies are counted [J]."""
        return self.potential - 0.5 * self.risen


def carried_by(
    body: Body, which: NDArray[np.bool_], grid: Grid, basis: Basis, gravity: Sequence[float], last_step: float
) -> Carried:
    """What some points of a body carry, after a step [s]."""
    masses, velocity = body.masses[which], body.velocity[:, which].astype(np.float64)
    affine, acceleration = body.affine[:, :, which].astype(np.float64), np.array(gravity)
    above = body.positions[:, which] - np.array(grid.lower)[:, np.newaxis]
    moments = grid.cell_size**2 * _moments(above / grid.cell_size + GHOSTS, basis)
    squares = (velocity**2).sum(axis=0) + ((affine**2).sum(axis=0) * moments).sum(axis=0)
    return Carried(
        mass=float(masses.sum()),
        kinetic=0.5 * float((masses * squares).sum()),
        potential=-float((masses * (acceleration @ above)).sum()),
        risen=-last_step * float((masses * (acceleration @ velocity)).sum()),
        elastic=elastic_energy(body, np.ascontiguousarray(body.points[:, which])),
    )


def all_carried(found: Sequence[Carried]) -> Carried | None:
    """The sums over several; None over none."""
    return Carried(*map(sum, zip(*found, strict=True))) if found else None


def _moments(places: Floats, basis: Basis) -> Floats:
    """The second moment of the shape functions along each axis at places [cells], in squares of the cell size."""
    moment: Any = basis.moment
    return np.asarray(moment(places - np.trunc(places - basis.offset)) + np.zeros_like(places))
