"""What sleep does on the nodes and at the points (`stepping.sleeping`): copying, holding, marking what is stirred."""

import numpy as np
from numba import njit, prange

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.grid import COMPONENTS, MASS, NEW_VX, NEW_VY
from grainlaw.mpm_core.kernels.shape_functions import first_node
from grainlaw.mpm_core.kernels.sources import CORE_MARK

# Nodes around what moves that are awake.
RING = 3


@njit(parallel=True, cache=True)
@named(CORE_MARK)
def copy_nodes(source, target, nodes_y, active):  # type: ignore[no-untyped-def]
    """Copy the active nodes."""
    for i in prange(active.first_column, active.last_column + 1):
        if active.last_rows[i] >= active.first_rows[i]:
            first, last = (
                (i * nodes_y + active.first_rows[i]) * COMPONENTS,
                (i * nodes_y + active.last_rows[i] + 1) * COMPONENTS,
            )
            target[first:last] = source[first:last]


@njit(parallel=True, cache=True)
@named(CORE_MARK)
def hold_sleepers(nodes, held, withheld, active):  # type: ignore[no-untyped-def]
    """Hold the nodes with sleeping mass, and sum up the momentum that is withheld from them."""
    for i in prange(active.first_column, active.last_column + 1):
        for j in range(active.first_rows[i], active.last_rows[i] + 1):
            node = (i * withheld.shape[1] + j) * COMPONENTS
            if held[i, j]:
                withheld[i, j, 0] += nodes[node + MASS] * nodes[node + NEW_VX]
                withheld[i, j, 1] += nodes[node + MASS] * nodes[node + NEW_VY]
                nodes[node + NEW_VX] = nodes[node + NEW_VY] = 0.0


@njit(cache=True)
@named(CORE_MARK)
def stir_nodes(withheld, waking_squared, active, stirred):  # type: ignore[no-untyped-def]
    """Mark what is around the nodes from which too much is withheld; returns whether there are any.

    Of marks, here and below, there are `RING` rows beyond each side of the grid.
    """
    found = False
    for i in range(active.first_column, active.last_column + 1):
        for j in range(active.first_rows[i], active.last_rows[i] + 1):
            if withheld[i, j, 0] ** 2 + withheld[i, j, 1] ** 2 > waking_squared:
                stirred[i : i + 2 * RING + 1, j : j + 2 * RING + 1] = True
                found = True
    return found


@njit(cache=True)
@named(CORE_MARK)
def stir_around_points(x, y, origin, cell_size, offset, width, stirred):  # type: ignore[no-untyped-def]
    """Mark what is around points."""
    for p in range(len(x)):
        i, j = first_node(x[p], y[p], origin, cell_size, offset)
        stirred[i : i + width + 2 * RING, j : j + width + 2 * RING] = True


@njit(cache=True)
@named(CORE_MARK)
def touches_stirred(x, y, origin, cell_size, offset, width, stirred):  # type: ignore[no-untyped-def]
    """Whether any node of the stencil of each point is marked."""
    touched = np.empty(len(x), np.bool_)
    for p in range(len(x)):
        i, j = first_node(x[p], y[p], origin, cell_size, offset)
        i, j = i + RING, j + RING
        touched[p] = stirred[i : i + width, j : j + width].any()
    return touched
