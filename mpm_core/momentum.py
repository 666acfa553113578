"""The momentum equation on the grid: m dv/dt = f + m g."""

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray

from materials.compilation import named
from mpm_core.grid import (
    COMPONENTS,
    FX,
    FY,
    MASS,
    NEW_VX,
    NEW_VY,
    NODE_CROWDING,
    NODE_DENSITY,
    NODE_PRESSURE,
    OLD_VX,
    OLD_VY,
    PX,
    PY,
    VOLUME,
    VOLUME_PRESSURE,
    Grid,
)
from mpm_core.reach import Reach
from mpm_core.sources import CORE_MARK
from mpm_core.volumes import crowding_of


def clear(nodes: NDArray[np.float64], grid: Grid, reach: Reach) -> None:
    """Zero the nodes in reach, of the grid or of another array like its nodes."""
    _clear(nodes, grid.shape[1], reach.first_rows, reach.last_rows)


def update_velocities(grid: Grid, reach: Reach, gravity: tuple[float, float], dt: float) -> None:
    """Turn what was scattered into old velocity and new velocity v + dt (f/m + g) [m/s]."""
    rows = (reach.first_rows, reach.last_rows)
    _update(grid.nodes, grid.shape[1], *rows, dt * gravity[0], dt * gravity[1], dt)


def average_surroundings(grid: Grid, reach: Reach) -> None:
    """Turn the volumes and pressures that were scattered into the averages of which `volumes` are tied."""
    rows, room = (reach.first_rows, reach.last_rows), (*grid.rooms, grid.cell_size**2)
    _average(grid.nodes, grid.shape[1], *rows, *room)


@njit(parallel=True, cache=True)
@named(CORE_MARK)
def _clear(nodes, nodes_y, first_rows, last_rows):  # type: ignore[no-untyped-def]
    for i in prange(len(first_rows)):
        if last_rows[i] >= first_rows[i]:
            row = i * nodes_y
            nodes[(row + first_rows[i]) * COMPONENTS : (row + last_rows[i] + 1) * COMPONENTS] = 0.0


@njit(parallel=True, error_model="numpy", cache=True)
@named(CORE_MARK)
def _update(nodes, nodes_y, first_rows, last_rows, impulse_x, impulse_y, dt):  # type: ignore[no-untyped-def]
    for i in prange(len(first_rows)):
        for j in range(first_rows[i], last_rows[i] + 1):
            node = np.uint64((i * nodes_y + j) * COMPONENTS)
            mass = nodes[node + np.uint64(MASS)]
            if mass > 0.0:
                inverse = 1.0 / mass
                old_x, old_y = nodes[node + np.uint64(PX)] * inverse, nodes[node + np.uint64(PY)] * inverse
                push_x, push_y = nodes[node + np.uint64(FX)] * inverse, nodes[node + np.uint64(FY)] * inverse
                nodes[node + np.uint64(NEW_VX)] = old_x + dt * push_x + impulse_x
                nodes[node + np.uint64(NEW_VY)] = old_y + dt * push_y + impulse_y
                nodes[node + np.uint64(OLD_VX)] = old_x
                nodes[node + np.uint64(OLD_VY)] = old_y


@njit(parallel=True, error_model="numpy", cache=True)
@named(CORE_MARK)
def _average(nodes, nodes_y, first_rows, last_rows, rooms_x, rooms_y, cell):  # type: ignore[no-untyped-def]
    for i in prange(len(first_rows)):
        for j in range(first_rows[i], last_rows[i] + 1):
            node = np.uint64((i * nodes_y + j) * COMPONENTS)
            mass = nodes[node + np.uint64(MASS)]
            if mass > 0.0:
                volume = nodes[node + np.uint64(VOLUME)]
                nodes[node + np.uint64(NODE_CROWDING)] = crowding_of(volume, cell * rooms_x[i] * rooms_y[j])
                nodes[node + np.uint64(NODE_PRESSURE)] = nodes[node + np.uint64(VOLUME_PRESSURE)] / volume
                nodes[node + np.uint64(NODE_DENSITY)] = mass / volume
