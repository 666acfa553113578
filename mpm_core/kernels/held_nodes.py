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


def hold_nodes(grid: Grid, nodes: NDArray[np.int64]) -> float:
    """Set the new velocity of these nodes to zero.

    Returns by how much the work of the forces on the nodes changes thereby [J and the space's amount] (`walls`).
    """
    if len(nodes) == 0:
        return 0.0
    of_node, axes, each = grid.components, grid.space.axes, grid.nodes.reshape(-1, COMPONENTS)
    new, old = (each[nodes, first : first + axes].astype(float) for first in (of_node.momentum, of_node.force))
    column, row = np.divmod(nodes, grid.shape[-1])
    is_counted = grid.counted.columns[column] & (grid.counted.first_row <= row) & (row < grid.counted.row_behind)
    each[nodes, of_node.momentum : of_node.momentum + axes] = 0.0
    return -0.5 * float((is_counted * each[nodes, of_node.mass] * (new * (new - old)).sum(axis=1)).sum())
