"""Nodes at which a program holds the material: a boundary of any shape, to the accuracy of a cell.

It is no part of a scene file; manufactured solutions set `Simulation.held_nodes`.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.grid.grid import COMPONENTS, Grid

Array = NDArray[np.float64]


def nodes_where(grid: Grid, condition: Callable[..., NDArray[np.bool_]]) -> NDArray[np.int64]:
    """Numbers of the nodes at whose coordinates x, y (and z) [m] a condition holds, shape (n,)."""
    along = [
        start + grid.cell_size * np.arange(nodes, dtype=np.float64)
        for start, nodes in zip(grid.origin, grid.shape, strict=True)
    ]
    return np.flatnonzero(condition(*np.meshgrid(*along, indexing="ij", sparse=True)))


def hold_nodes(grid: Grid, nodes: NDArray[np.int64]) -> None:
    """Set the new velocity of these nodes to zero."""
    if len(nodes) > 0:
        first = grid.components.momentum
        grid.nodes.reshape(-1, COMPONENTS)[nodes, first : first + grid.space.axes] = 0.0
