"""The rows of the point array: one contiguous row of memory per quantity, the same order for every law.

The law's state variables follow after `FIRST_STATE`, in the order of its declaration, and the accumulated shear strain
after them, where a scene writes it. Points in single precision end with what singles leave out of what grows by steps
that are small beside it: density and positions.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials.precision import PRECISIONS

NAMES = (
    *("x", "y", "velocity_x", "velocity_y"),
    *("gradient_xx", "gradient_xy", "gradient_yx", "gradient_yy"),
    *("affine_xx", "affine_xy", "affine_yx", "affine_yy"),
    *("stress_xx", "stress_yy", "stress_zz", "stress_xy"),
    *("density", "neighbour_pressure", "neighbour_density"),
)
X, Y = 0, 1
VX, VY = 2, 3
LXX, LXY, LYX, LYY = 4, 5, 6, 7
AXX, AXY, AYX, AYY = 8, 9, 10, 11
GRADIENT, AFFINE = slice(4, 8), slice(8, 12)
SXX, SYY, SZZ, SXY = 12, 13, 14, 15
DENSITY = 16
# What a point gathers of the material around it.
NEIGHBOUR_PRESSURE, NEIGHBOUR_DENSITY = 17, 18
FIRST_STATE = len(NAMES)

# From the end, in single precision.
DENSITY_REMAINDER, X_REMAINDER, Y_REMAINDER = -3, -2, -1
REMAINDERS = ("density_remainder", "x_remainder", "y_remainder")

# In bytes.
CACHE_LINE = 64


def allocate(rows: int, points: int, precision: str = "double") -> NDArray[Any]:
    """Zeroed rows of numbers for some points, in whole cache lines, that do not fall on the same cache sets.

    Rows a multiple of 4096 bytes apart would evict one another; an odd number of cache lines between them cannot.
    """
    number = PRECISIONS[precision]
    per_line = CACHE_LINE // np.dtype(number).itemsize
    lines = -(-points // per_line)
    lines += 1 - lines % 2
    return np.zeros((rows, lines * per_line), number)
