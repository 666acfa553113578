"""From points to fields on a lattice, with one kernel for grains and material points alike.

A quantity q of each grain becomes the field sum_i q_i W(x - x_i) W(z - z_i) / depth, with W a Gaussian whose standard
deviation is one mean grain diameter, evaluated at the cell centres of a lattice (Goldhirsch 2010, Granular Matter 12:
239; Weinhart et al. 2012, Granular Matter 14: 289). The floor reflects: material near it is not smeared below it.

Around an axis x is the distance from it, and a grain at R is spread over the ring at r by the mean over the angle of
the same Gaussian in two dimensions, exp(-(r^2 + R^2)/(2 s^2)) I0(r R/s^2)/(2 pi s^2): no ring is too small for it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.special import i0e

from grainlaw.mpm_core.space import AXISYMMETRIC, PLANE_STRAIN, Space
from grainlaw.validation.grains.snapshot import Array, GrainSnapshot, StressMoments

SPACING = 0.0075
# Beyond it lies less than 1e-4 of a Gaussian.
REACH_IN_WIDTHS = 4.0


@dataclass(frozen=True)
class Lattice:
    """Cells of equal size; `x` and `z` are their centres [m], the first row of cells stands on the floor.

    In axisymmetry `x` is the radius of rings, from the axis on.
    """

    x: Array
    z: Array
    spacing: float
    floor: float
    space: Space = PLANE_STRAIN

    @property
    def weights(self) -> Array:
        """What each column of cells counts for in a mean, shape (x,)."""
        return column_weights(self.x, self.space)


def column_weights(x: Array, space: Space) -> Array:
    """What columns of cells at `x` count for in a sum over x: all the same, or the radius of a ring."""
    return x if space.hoop else np.ones_like(x)


def column_lattice(center: float, half_width: float, floor: float, height: float, spacing: float = SPACING) -> Lattice:
    """The lattice with cells on both sides of `center` and above `floor` that covers the lengths [m] given."""
    columns, rows = int(np.ceil(half_width / spacing)), int(np.ceil(height / spacing))
    x = center + (np.arange(-columns, columns) + 0.5) * spacing
    return Lattice(x, floor + (np.arange(rows) + 0.5) * spacing, spacing, floor)


def disc_lattice(radius: float, floor: float, height: float, spacing: float = SPACING) -> Lattice:
    """The lattice of rings around an axis, above `floor`, that covers the lengths [m] given."""
    columns, rows = int(np.ceil(radius / spacing)), int(np.ceil(height / spacing))
    x = (np.arange(columns) + 0.5) * spacing
    return Lattice(x, floor + (np.arange(rows) + 0.5) * spacing, spacing, floor, AXISYMMETRIC)


@dataclass(frozen=True)
class Kernel:
    """The weights of n points in the cells of a lattice, each of shape (n, cells).

    across  [1/m], over a `depth` [m]; in axisymmetry [1/m2], with a depth of 1
    up      [1/m]
    """

    across: csr_array
    up: csr_array
    depth: float

    def field(self, quantity: Array) -> Array:
        """The density of a quantity of shape (n,) per volume, shape (len(x), len(z))."""
        return np.asarray((self.across.T @ self.up.multiply(quantity[:, None]).tocsr()).todense()) / self.depth


def kernel_of(positions: Array, lattice: Lattice, width: float, depth: float = 1.0) -> Kernel:
    """The kernel of points at `positions` (n, 3) [m], with a Gaussian of standard deviation `width` [m].

    On a lattice of rings the axis is that of x = y = 0, and `depth` does not matter.
    """
    heights = positions[:, 2]
    up = _gaussian(heights, lattice.z, lattice.spacing, width)
    image = _gaussian(2.0 * lattice.floor - heights, lattice.z, lattice.spacing, width)
    if lattice.space.hoop:
        return Kernel(_ring(np.hypot(positions[:, 0], positions[:, 1]), lattice, width), up + image, 1.0)
    return Kernel(_gaussian(positions[:, 0], lattice.x, lattice.spacing, width), up + image, depth)


def _gaussian(coordinates: Array, centers: Array, spacing: float, width: float) -> csr_array:
    """Gaussian weights [1/m] of points in cells along one axis, shape (points, cells)."""
    cells, at = _near(coordinates, centers, spacing, width)
    distance = (at - coordinates[:, None]) / width
    return _sparse(cells, np.exp(-0.5 * distance**2) / (np.sqrt(2.0 * np.pi) * width), len(centers))


def _ring(radii: Array, lattice: Lattice, width: float) -> csr_array:
    """Weights [1/m2] of points at these distances from the axis in the rings, shape (points, rings)."""
    cells, at = _near(radii, lattice.x, lattice.spacing, width)
    distance = (at - radii[:, None]) / width
    around = i0e(np.abs(at) * radii[:, None] / width**2)
    return _sparse(cells, np.exp(-0.5 * distance**2) * around / (2.0 * np.pi * width**2), len(lattice.x))


def _near(coordinates: Array, centers: Array, spacing: float, width: float) -> tuple[NDArray[np.int64], Array]:
    """The cells within reach of each point, beyond the lattice too, and their centres; shape (points, cells)."""
    reach = int(np.ceil(REACH_IN_WIDTHS * width / spacing))
    nearest = np.rint((coordinates - centers[0]) / spacing).astype(np.int64)
    cells = nearest[:, None] + np.arange(-reach, reach + 1)
    return cells, centers[0] + spacing * cells


def _sparse(cells: NDArray[np.int64], weights: Array, count: int) -> csr_array:
    inside = (cells >= 0) & (cells < count)
    points: NDArray[np.int64] = np.broadcast_to(np.arange(len(cells))[:, None], cells.shape)
    return csr_array((weights[inside], (points[inside], cells[inside])), shape=(len(cells), count))


def solid_fraction(snapshot: GrainSnapshot, kernel: Kernel) -> Array:
    """phi(x, z) [1]."""
    return kernel.field(snapshot.solid_volumes)


def stress(moments: StressMoments, lattice: Lattice, width: float, depth: float) -> tuple[Array, Array, Array]:
    """The components xx, zz, xz of the stress [Pa], compression-positive, each of shape (len(x), len(z))."""
    kernel = kernel_of(moments.positions, lattice, width, depth)
    xx, zz, xz = (kernel.field(component) for component in moments.values.T)
    return xx, zz, xz
