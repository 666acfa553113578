"""The momentum equation on the grid: m dv/dt = f + m g."""

import numpy as np
from numba import njit, prange

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
    Window,
)
from mpm_core.sources import CORE_MARK
from mpm_core.volumes import crowding_of


def clear(grid: Grid, window: Window) -> None:
    """Zero the nodes of a window."""
    _clear(grid.nodes, grid.shape[1], window.first_x, window.last_x, window.first_y, window.last_y)


def update_velocities(grid: Grid, window: Window, gravity: tuple[float, float], dt: float) -> None:
    """Turn what was scattered into old velocity, new velocity v + dt (f/m + g) [m/s], and averages for `volumes`."""
    bounds = (window.first_x, window.last_x, window.first_y, window.last_y)
    room = (*grid.rooms, grid.cell_size**2)
    _update(grid.nodes, grid.shape[1], *bounds, *room, dt * gravity[0], dt * gravity[1], dt)


@njit(parallel=True, cache=True)
@named(CORE_MARK)
def _clear(nodes, nodes_y, first_x, last_x, first_y, last_y):  # type: ignore[no-untyped-def]
    for i in prange(first_x, last_x + 1):
        start = (i * nodes_y + first_y) * COMPONENTS
        nodes[start : (i * nodes_y + last_y + 1) * COMPONENTS] = 0.0


@njit(parallel=True, error_model="numpy", cache=True)
@named(CORE_MARK)
def _update(  # type: ignore[no-untyped-def]
    nodes, nodes_y, first_x, last_x, first_y, last_y, rooms_x, rooms_y, cell, impulse_x, impulse_y, dt
):
    for i in prange(first_x, last_x + 1):
        for j in range(first_y, last_y + 1):
            node = np.uint64((i * nodes_y + j) * COMPONENTS)
            mass = nodes[node + np.uint64(MASS)]
            if mass > 0.0:
                old_x = nodes[node + np.uint64(PX)] / mass
                old_y = nodes[node + np.uint64(PY)] / mass
                new_x = old_x + dt * nodes[node + np.uint64(FX)] / mass + impulse_x
                new_y = old_y + dt * nodes[node + np.uint64(FY)] / mass + impulse_y
                nodes[node + np.uint64(NEW_VX)] = new_x
                nodes[node + np.uint64(NEW_VY)] = new_y
                volume = nodes[node + np.uint64(VOLUME)]
                nodes[node + np.uint64(NODE_CROWDING)] = crowding_of(volume, cell * rooms_x[i] * rooms_y[j])
                nodes[node + np.uint64(NODE_PRESSURE)] = nodes[node + np.uint64(VOLUME_PRESSURE)] / volume
                nodes[node + np.uint64(NODE_DENSITY)] = mass / volume
                nodes[node + np.uint64(OLD_VX)] = old_x
                nodes[node + np.uint64(OLD_VY)] = old_y
