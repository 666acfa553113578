"""The rows of the point array: one contiguous row of memory per quantity, the same order for every law.

Each space has a layout of its own. The law's state variables follow after `Layout.first_state`, in the order of its
declaration, and the accumulated shear strain after them, where a scene writes it. Points in single precision end with
what singles leave out of what grows by steps that are small beside it: density and positions.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials.precision import PRECISIONS
from grainlaw.materials.tensor import SymmetricTensor
from grainlaw.mpm_core.space import Space

# Coordinates come first in every space.
POSITION = 0
# From the end, in single precision: the density, and before it the coordinates in their order.
DENSITY_REMAINDER = -1

# In bytes.
CACHE_LINE = 64


class Layout(NamedTuple):
    """The numbers of the rows of a space; of quantities with several components that of the first.

    velocity            v
    gradient            L_ij = dv_i/dx_j, row after row
    affine              A_ij, the velocity gradient that a point brings to the grid
    stress              those components that the space has, in the order of `SymmetricTensor`
    stress_names        their names
    density             bulk density
    neighbour_pressure  mean pressure around
    neighbour_density   bulk density around
    hoop_gradient       L_zz = v_r/r, around the axis of axisymmetry; -1 elsewhere
    mass                of each point, in axisymmetry; -1 elsewhere, where all points of a body have the same
    first_state         the law's first state variable
    names               of all rows before it
    remainders          of the rows at the end in single precision
    """

    velocity: int
    gradient: int
    affine: int
    stress: int
    stress_names: tuple[str, ...]
    density: int
    neighbour_pressure: int
    neighbour_density: int
    hoop_gradient: int
    mass: int
    first_state: int
    names: tuple[str, ...]
    remainders: tuple[str, ...]

    @property
    def velocities(self) -> slice:
        """The rows of the velocity."""
        return slice(self.velocity, self.gradient)

    @property
    def gradients(self) -> slice:
        """The rows of both velocity gradients, L and A, of the grid's axes."""
        return slice(self.gradient, self.stress)

    @property
    def stresses(self) -> slice:
        """The rows of the stress."""
        return slice(self.stress, self.density)

    @property
    def position_remainder(self) -> int:
        """The row of the first coordinate's remainder, from the end."""
        return -len(self.remainders)


@cache
def layout_of(space: Space) -> Layout:
    """The layout of a space."""
    axes = space.axis_names
    pairs = [a + b for a in axes for b in axes]
    stresses = SymmetricTensor._fields[: 6 if space.axes == 3 else 4]
    of_space = ("gradient_zz", "mass") if space.hoop else ()
    names = (
        *axes,
        *(f"velocity_{axis}" for axis in axes),
        *(f"gradient_{pair}" for pair in pairs),
        *(f"affine_{pair}" for pair in pairs),
        *(f"stress_{component}" for component in stresses),
        *("density", "neighbour_pressure", "neighbour_density", *of_space),
    )
    return Layout(
        velocity=names.index("velocity_x"),
        gradient=names.index("gradient_xx"),
        affine=names.index("affine_xx"),
        stress=names.index("stress_xx"),
        stress_names=stresses,
        density=names.index("density"),
        neighbour_pressure=names.index("neighbour_pressure"),
        neighbour_density=names.index("neighbour_density"),
        hoop_gradient=names.index("gradient_zz") if space.hoop else -1,
        mass=names.index("mass") if space.hoop else -1,
        first_state=len(names),
        names=names,
        remainders=(*(f"{axis}_remainder" for axis in axes), "density_remainder"),
    )


def allocate(rows: int, points: int, precision: str = "double") -> NDArray[Any]:
    """Zeroed rows of numbers for some points, in whole cache lines, that do not fall on the same cache sets.

    Rows a multiple of 4096 bytes apart would evict one another; an odd number of cache lines between them cannot.
    """
    number = PRECISIONS[precision]
    per_line = CACHE_LINE // np.dtype(number).itemsize
    lines = -(-points // per_line)
    lines += 1 - lines % 2
    return np.zeros((rows, lines * per_line), number)
