"""Nodes at which a program holds the material: a boundary of any shape, to the accuracy of a cell.

It is no part of a scene file; manufactured solutions set `Simulation.held_nodes`.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.grid.grid import COMPONENTS, NEW_VX, NEW_VY, Grid

Array = NDArray[np.float64]


def nodes_where(grid: Grid, condition: Callable[[Array, Array], NDArray[np.bool_]]) -> NDArray[np.int64]:
    """Numbers of the nodes at whose coordinates x and y [m] a condition holds, shape (n,)."""
    x, y = (grid.origin[axis] + grid.cell_size * np.arange(grid.shape[axis], dtype=np.float64) for axis in (0, 1))
    return np.flatnonzero(condition(x[:, None], y[None, :]))


def hold_nodes(grid: Grid, nodes: NDArray[np.int64]) -> None:
    """Set the new velocity of these nodes to zero."""
    if len(nodes) > 0:
        grid.nodes.reshape(-1, COMPONENTS)[nodes, NEW_VX : NEW_VY + 1] = 0.0
