"""What sleep does on the nodes and at the points (`stepping.sleeping`): copying, holding, marking what is stirred.

Marks are arrays over the nodes of the grid and `RING` more beyond each of its sides.
"""

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.grid import COMPONENTS
from grainlaw.mpm_core.kernels.shape_functions import first_node
from grainlaw.mpm_core.kernels.sources import CORE_MARK

# Nodes around what moves that are awake.
RING = 3


@njit(parallel=True, cache=True)
@named(CORE_MARK)
def copy_nodes(source, target, components, column, active):  # type: ignore[no-untyped-def]
    """Copy so many numbers of each active node."""
    for i in prange(active.first_column, active.last_column + 1):
        if active.last_rows[i] >= active.first_rows[i]:
            first = (i * column + active.first_rows[i]) * components
            last = (i * column + active.last_rows[i] + 1) * components
            target[first:last] = source[first:last]


@njit(parallel=True, cache=True)
@named(CORE_MARK)
def hold_sleepers(nodes, of_node, held, withheld, column, active, counted):  # type: ignore[no-untyped-def]
    """Hold the nodes with sleeping mass, and sum up the momentum that is withheld from them, shape (nodes, axes).

    Returns by how much the work of the forces on the nodes of each column changes thereby (`walls`).
    """
    works = np.zeros(active.last_column - active.first_column + 1)
    for i in prange(active.first_column, active.last_column + 1):
        twice_work = 0.0
        for j in range(active.first_rows[i], active.last_rows[i] + 1):
            number = i * column + j
            if held[number]:
                node = number * COMPONENTS
                for axis in range(withheld.shape[1]):
                    velocity = node + of_node.momentum + axis
                    momentum = nodes[node + of_node.mass] * nodes[velocity]
                    withheld[number, axis] += momentum
                    if counted.first_row <= j < counted.row_behind:
                        twice_work -= momentum * (nodes[velocity] - nodes[node + of_node.force + axis])
                    nodes[velocity] = 0.0
        works[i - active.first_column] = 0.5 * twice_work if counted.columns[i] else 0.0
    return works


@njit(cache=True)
@named(CORE_MARK)
def nodes_to_wake(withheld, waking_squared, column, active):  # type: ignore[no-untyped-def]
    """Which of the nodes, one after another, too much is withheld from; nodes that are not active have nothing."""
    found = np.zeros(len(withheld), np.bool_)
    for i in range(active.first_column, active.last_column + 1):
        for j in range(active.first_rows[i], active.last_rows[i] + 1):
            squared = 0.0
            for axis in range(withheld.shape[1]):
                squared += withheld[i * column + j, axis] ** 2
            found[i * column + j] = squared > waking_squared
    return found


@register_jitable
def _number(places, p, origin, cell_size, offset, shape):  # type: ignore[no-untyped-def]
    """Where the first node of the stencil of a point is among the marks, one after another."""
    number = 0
    for axis in range(len(origin)):
        number = number * shape[axis] + first_node(places[axis, p], origin[axis], cell_size, offset) + RING
    return number


@njit(cache=True)
@named(CORE_MARK)
def mark_first_nodes(places, origin, cell_size, offset, shape, marks):  # type: ignore[no-untyped-def]
    """Mark the first node of the stencil of each point, among marks of a shape, one after another."""
    for p in range(places.shape[1]):
        marks[_number(places, p, origin, cell_size, offset, shape)] = True


@njit(cache=True)
@named(CORE_MARK)
def first_node_is_marked(places, origin, cell_size, offset, shape, marks):  # type: ignore[no-untyped-def]
    """Whether the first node of the stencil of each point is marked."""
    is_marked = np.empty(places.shape[1], np.bool_)
    for p in range(places.shape[1]):
        is_marked[p] = marks[_number(places, p, origin, cell_size, offset, shape)]
    return is_marked


def spread(marks: NDArray[np.bool_], before: int, behind: int) -> NDArray[np.bool_]:
    """The marks, and along each axis so many nodes before and behind each of them."""
    for axis in range(marks.ndim):
        source, marks = np.moveaxis(marks, axis, 0), marks.copy()
        target = np.moveaxis(marks, axis, 0)
        for way in range(1, behind + 1):
            target[way:] |= source[:-way]
        for way in range(1, before + 1):
            target[:-way] |= source[way:]
    return marks
