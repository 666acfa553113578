"""The momentum equation on the grid: m dv/dt = f + m g."""

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.active_nodes import ActiveNodes
from grainlaw.mpm_core.grid.grid import (
    COMPONENTS,
    MASS,
    NODE_DENSITY,
    NODE_PRESSURE,
    VOLUME,
    VOLUME_PRESSURE,
    Grid,
)
from grainlaw.mpm_core.kernels.simd.arithmetic import halves_joined, halves_swapped
from grainlaw.mpm_core.kernels.simd.registers import put, quad_at
from grainlaw.mpm_core.kernels.sources import CORE_MARK


def clear_nodes(nodes: NDArray[np.float64], grid: Grid, active: ActiveNodes) -> None:
    """Zero the active nodes, of the grid or of another array like its nodes."""
    _clear(nodes, grid.shape[1], active)


def update_nodes(grid: Grid, active: ActiveNodes, gravity: tuple[float, float], dt: float, couples: bool) -> None:
    """Turn what was scattered into old velocity and new velocity v + dt (f/m + g) [m/s].

    If `couples`, turn the volumes and pressures as well, into the averages that `volume_coupling` takes.
    """
    _update(grid.nodes, grid.shape[1], active, gravity[0], gravity[1], dt, couples)


@njit(parallel=True, cache=True)
@named(CORE_MARK)
def _clear(nodes, nodes_y, active):  # type: ignore[no-untyped-def]
    for i in prange(active.first_column, active.last_column + 1):
        if active.last_rows[i] >= active.first_rows[i]:
            row = i * nodes_y
            nodes[(row + active.first_rows[i]) * COMPONENTS : (row + active.last_rows[i] + 1) * COMPONENTS] = 0.0


@njit(parallel=True, error_model="numpy", cache=True)
@named(CORE_MARK)
def _update(nodes, nodes_y, active, gravity_x, gravity_y, dt, couples):  # type: ignore[no-untyped-def]
    impulse = np.array([dt * gravity_x, dt * gravity_y, 0.0, 0.0])
    for i in prange(active.first_column, active.last_column + 1):
        fall = quad_at(impulse, 0)
        for j in range(active.first_rows[i], active.last_rows[i] + 1):
            node = np.uint64((i * nodes_y + j) * COMPONENTS)
            mass = nodes[node + np.uint64(MASS)]
            if mass > 0.0:
                old_and_push = quad_at(nodes, node) * (1.0 / mass)
                push_and_old = halves_swapped(old_and_push)
                new = old_and_push + dt * push_and_old + fall
                put(nodes, node, halves_joined(new, push_and_old))
                if couples:
                    _average(nodes, node, mass)


@register_jitable(forceinline=True)
def _average(nodes, node, mass):  # type: ignore[no-untyped-def]
    per_volume = 1.0 / nodes[node + np.uint64(VOLUME)]
    nodes[node + np.uint64(NODE_PRESSURE)] = nodes[node + np.uint64(VOLUME_PRESSURE)] * per_volume
    nodes[node + np.uint64(NODE_DENSITY)] = mass * per_volume
