"""How the material in a turning drum lies and moves; the same definitions for grains and for material points.

The drum's axis is x = z = 0 and carries material up at x > 0.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import map_coordinates

from grainlaw.validation.grains.coarse_graining import Lattice, column_lattice, kernel_of
from grainlaw.validation.grains.snapshot import Array, GrainSnapshot
from grainlaw.validation.grains.surface import surface_height

# Solid fraction at the surface, and the part of the radius on both sides of the axis where its angle is taken.
LEVEL, MIDDLE = 0.3, 0.4
# Room for the kernel around the drum, in its widths.
MARGIN = 4.0


@dataclass(frozen=True)
class Drum:
    """Radius [m] of the space in the drum, width of the kernel [m], and the depth averaged over [m]."""

    radius: float
    width: float
    depth: float

    @property
    def lattice(self) -> Lattice:
        """A square around the drum."""
        reach = self.radius + MARGIN * self.width
        return column_lattice(0.0, reach, -reach, 2.0 * reach)


@dataclass(frozen=True)
class Flow:
    """Means over some time, on the lattice of a drum.

    phi           solid fraction, shape (x, z) [1]
    flux          volume of solid through a unit of area and time, along x and z, shape (2, x, z) [m/s]
    center        of mass, (x, z) [m]
    """

    drum: Drum
    phi: Array
    flux: Array
    center: Array

    @property
    def surface(self) -> Array:
        """Level of the surface over the axis [m] in each column of cells: where phi falls through 0.3."""
        lattice = self.drum.lattice
        return surface_height(self.phi, lattice, 2.0 * LEVEL) + lattice.floor

    @property
    def line(self) -> tuple[float, float]:
        """Slope [1], and level over the axis [m], of the straight line through the middle of the surface."""
        x = self.drum.lattice.x
        middle = np.abs(x) < MIDDLE * self.drum.radius
        slope, level = np.polyfit(x[middle], self.surface[middle], 1)
        return float(slope), float(level)

    @property
    def angle(self) -> float:
        """Of the surface [degrees]."""
        return float(np.degrees(np.arctan(self.line[0])))

    def across(self, places: Array) -> tuple[Array, Array]:
        """Solid fraction [1], and velocity down the slope [m/s], at places along the normal of the surface.

        Places [m] count from the axis, outwards through the surface. Velocity is flux over solid fraction.
        """
        along, normal = _directions(self.line[0])
        lattice = self.drum.lattice
        at = (normal[:, None] * places - [[lattice.x[0]], [lattice.z[0]]]) / lattice.spacing
        phi, x, z = (map_coordinates(field, at, order=1) for field in (self.phi, *self.flux))
        with np.errstate(invalid="ignore", divide="ignore"):
            return phi, -(along[0] * x + along[1] * z) / phi

    @property
    def layer(self) -> tuple[float, float]:
        """Thickness of what flows down at the axis [m], and its speed at the surface [m/s].

        It ends where the velocity turns. NaN where nothing flows down.
        """
        slope, level = self.line
        top = level / np.hypot(1.0, slope)
        places = np.linspace(-self.drum.radius, top, 400)
        _, speed = self.across(places)
        rising = np.flatnonzero(~(speed > 0.0))
        if len(rising) == 0 or rising[-1] + 1 == len(places):
            return np.nan, np.nan
        return float(top - places[rising[-1] + 1]), float(speed[-1])


def mean_flow(snapshots: Sequence[GrainSnapshot], drum: Drum) -> Flow:
    """The mean over the snapshots."""
    fields = np.mean([_fields(snapshot, drum) for snapshot in snapshots], axis=0)
    centers = [np.average(one.positions[:, [0, 2]], axis=0, weights=one.solid_volumes) for one in snapshots]
    return Flow(drum, fields[0], fields[1:], np.mean(centers, axis=0))


def mean_of_flows(flows: Sequence[Flow]) -> Flow:
    """The mean over parts of equal length of the time."""
    return Flow(
        flows[0].drum,
        np.mean([one.phi for one in flows], axis=0),
        np.mean([one.flux for one in flows], axis=0),
        np.mean([one.center for one in flows], axis=0),
    )


def _fields(snapshot: GrainSnapshot, drum: Drum) -> Array:
    """Solid fraction and both fluxes, shape (3, x, z)."""
    kernel = kernel_of(snapshot.positions, drum.lattice, drum.width, drum.depth)
    solid = snapshot.solid_volumes
    return np.array([kernel.field(solid * factor) for factor in (1.0, *snapshot.velocities[:, [0, 2]].T)])


def _directions(slope: float) -> tuple[Array, Array]:
    """Unit vectors up the slope and out of it."""
    length = np.hypot(1.0, slope)
    return np.array([1.0, slope]) / length, np.array([-slope, 1.0]) / length
