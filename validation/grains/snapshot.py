"""What every reader returns: the grains, or the material points, of one time."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class StressMoments:
    """Stress times volume at places, compression-positive: pieces of contacts, or material points.

    positions   shape (m, 3) [m]
    values      of the components xx, zz, xz, shape (m, 3) [Pa m3]
    """

    positions: Array
    values: Array


@dataclass(frozen=True)
class GrainSnapshot:
    """Grains at one time; x along the slope, y along the depth, z up.

    time            on the clock of the run that wrote them [s]
    positions       of the centres, shape (n, 3) [m]
    velocities      of the centres, shape (n, 3) [m/s]
    solid_volumes   volume of solid in each grain, shape (n,) [m3]; of a material point its mass over the grain density
    stress          None where contacts were not told
    """

    time: float
    positions: Array
    velocities: Array
    solid_volumes: Array
    stress: StressMoments | None = None

    @property
    def count(self) -> int:
        """Number of grains."""
        return len(self.solid_volumes)


def sphere_volumes(radii: Array) -> Array:
    """Volumes of spheres [m3] from their radii [m]."""
    return 4.0 / 3.0 * np.pi * radii**3


def sphere_diameters(volumes: Array) -> Array:
    """Diameters of spheres [m] from their volumes [m3]."""
    return 2.0 * np.cbrt(volumes / (4.0 / 3.0 * np.pi))
