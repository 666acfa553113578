"""From points to fields on a lattice, with one kernel for grains and material points alike.

A quantity q of each grain becomes the field sum_i q_i W(x - x_i) W(z - z_i) / depth, with W a Gaussian whose standard
deviation is one mean grain diameter, evaluated at the cell centres of a lattice (Goldhirsch 2010, Granular Matter 12:
239; Weinhart et al. 2012, Granular Matter 14: 289). The floor reflects: material near it is not smeared below it.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from grainlaw.validation.grains.snapshot import Array, GrainSnapshot, StressMoments

SPACING = 0.0075
# Beyond it lies less than 1e-4 of a Gaussian.
REACH_IN_WIDTHS = 4.0


@dataclass(frozen=True)
class Lattice:
    """Cells of equal size; `x` and `z` are their centres [m], the first row of cells stands on the floor."""

    x: Array
    z: Array
    spacing: float
    floor: float


def column_lattice(center: float, half_width: float, floor: float, height: float, spacing: float = SPACING) -> Lattice:
    """The lattice with cells on both sides of `center` and above `floor` that covers the lengths [m] given."""
    columns, rows = int(np.ceil(half_width / spacing)), int(np.ceil(height / spacing))
    x = center + (np.arange(-columns, columns) + 0.5) * spacing
    return Lattice(x, floor + (np.arange(rows) + 0.5) * spacing, spacing, floor)


@dataclass(frozen=True)
class Kernel:
    """The weights of n points in the cells of a lattice, for a Gaussian of standard deviation `width` [m]."""

    lattice: Lattice
    width: float
    positions: Array
    depth: float

    def field(self, quantity: Array) -> Array:
        """The density of a quantity of shape (n,) per volume, shape (len(x), len(z))."""
        across, up = self._weights
        return np.asarray((across.T @ up.multiply(quantity[:, None]).tocsr()).todense()) / self.depth

    @cached_property
    def _weights(self) -> tuple[csr_array, csr_array]:
        lattice = self.lattice
        heights = self.positions[:, 2]
        up = _gaussian(heights, lattice.z, lattice.spacing, self.width)
        image = _gaussian(2.0 * lattice.floor - heights, lattice.z, lattice.spacing, self.width)
        return _gaussian(self.positions[:, 0], lattice.x, lattice.spacing, self.width), up + image


def _gaussian(coordinates: Array, centers: Array, spacing: float, width: float) -> csr_array:
    """Gaussian weights [1/m] of points in cells along one axis, shape (points, cells)."""
    reach = int(np.ceil(REACH_IN_WIDTHS * width / spacing))
    nearest = np.rint((coordinates - centers[0]) / spacing).astype(np.int64)
    cells = nearest[:, None] + np.arange(-reach, reach + 1)
    distance = (centers[0] + spacing * cells - coordinates[:, None]) / width
    weights = np.exp(-0.5 * distance**2) / (np.sqrt(2.0 * np.pi) * width)
    inside = (cells >= 0) & (cells < len(centers))
    points: NDArray[np.int64] = np.broadcast_to(np.arange(len(coordinates))[:, None], cells.shape)
    return csr_array((weights[inside], (points[inside], cells[inside])), shape=(len(coordinates), len(centers)))


def grain_kernel(snapshot: GrainSnapshot, lattice: Lattice, width: float, depth: float) -> Kernel:
    """The kernel of the grains of a snapshot."""
    return Kernel(lattice, width, snapshot.positions, depth)


def solid_fraction(snapshot: GrainSnapshot, kernel: Kernel) -> Array:
    """phi(x, z) [1]."""
    return kernel.field(snapshot.solid_volumes)


def stress(moments: StressMoments, lattice: Lattice, width: float, depth: float) -> tuple[Array, Array, Array]:
    """The components xx, zz, xz of the stress [Pa], compression-positive, each of shape (len(x), len(z))."""
    kernel = Kernel(lattice, width, moments.positions, depth)
    xx, zz, xz = (kernel.field(component) for component in moments.values.T)
    return xx, zz, xz
