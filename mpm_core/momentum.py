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
    NODE_DENSITY,
    OLD_VX,
    OLD_VY,
    PX,
    PY,
    VOLUME,
    Grid,
)
from mpm_core.reach import Reach
from mpm_core.sources import CORE_MARK


def clear(grid: Grid, reach: Reach) -> None:
    """Zero the nodes in reach."""
    _clear(grid.nodes, grid.shape[1], reach.first_rows, reach.last_rows)


def update_velocities(grid: Grid, reach: Reach, gravity: tuple[float, float], dt: float) -> None:
    """Turn what was scattered into density, old velocity and new velocity v + dt (f/m + g) [m/s]."""
    _update(grid.nodes, grid.shape[1], reach.first_rows, reach.last_rows, dt * gravity[0], dt * gravity[1], dt)


@njit(parallel=True, cache=True)
@named(CORE_MARK)
def _clear(nodes, nodes_y, first_rows, last_rows):  # type: ignore[no-untyped-def]
    for i in prange(len(first_rows)):
        if last_rows[i] >= first_rows[i]:
            row = i * nodes_y
            nodes[(row + first_rows[i]) * COMPONENTS : (row + last_rows[i] + 1) * COMPONENTS] = 0.0


@njit(parallel=True, error_model="numpy", cache=True)
@named(CORE_MARK)
def _update(  # type: ignore[no-untyped-def]
    nodes, nodes_y, first_rows, last_rows, gravity_impulse_x, gravity_impulse_y, dt
):
    for i in prange(len(first_rows)):
        for j in range(first_rows[i], last_rows[i] + 1):
            node = np.uint64((i * nodes_y + j) * COMPONENTS)
            mass = nodes[node + np.uint64(MASS)]
            if mass > 0.0:
                inverse = 1.0 / mass
                old_x, old_y = nodes[node + np.uint64(PX)] * inverse, nodes[node + np.uint64(PY)] * inverse
                push_x, push_y = nodes[node + np.uint64(FX)] * inverse, nodes[node + np.uint64(FY)] * inverse
                nodes[node + np.uint64(NEW_VX)] = old_x + dt * push_x + gravity_impulse_x
                nodes[node + np.uint64(NEW_VY)] = old_y + dt * push_y + gravity_impulse_y
                nodes[node + np.uint64(OLD_VX)] = old_x
                nodes[node + np.uint64(OLD_VY)] = old_y
                nodes[node + np.uint64(NODE_DENSITY)] = mass / nodes[node + np.uint64(VOLUME)]
