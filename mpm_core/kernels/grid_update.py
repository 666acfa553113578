"""The momentum equation on the grid: m dv/dt = f + m g."""

from collections.abc import Callable
from functools import cache

import numpy as np
from numba import njit, prange
from numba.extending import register_jitable
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.grid.active_nodes import ActiveNodes
from grainlaw.mpm_core.grid.grid import BULK_COMPONENTS, COMPONENTS, NODE_OF, Grid
from grainlaw.mpm_core.kernels.sources import CORE_MARK


def clear_nodes(nodes: NDArray[np.float64], grid: Grid, active: ActiveNodes) -> None:
    """Zero the active nodes, of the grid or of another array like its nodes."""
    _clear(nodes, COMPONENTS, grid.shape[-1], active.columns)


def clear_bulk(bulk: NDArray[np.float64], grid: Grid, active: ActiveNodes) -> None:
    """Zero what the active nodes have in an array like `Grid.bulk`, if it has any."""
    if len(bulk) > 0:
        _clear(bulk, BULK_COMPONENTS, grid.shape[-1], active.columns)


def update_nodes(grid: Grid, active: ActiveNodes, gravity: tuple[float, ...], dt: float, couples: bool) -> None:
    """Turn what was scattered into old velocity and new velocity v + dt (f/m + g) [m/s].

    If `couples`, turn the volumes and pressures as well, into the averages that `volume_coupling` takes.
    """
    _make_update(grid.space.axes)(grid.nodes, grid.bulk, grid.shape[-1], active.columns, gravity, dt, couples)


@njit(parallel=True, cache=True)
@named(CORE_MARK)
def _clear(numbers, components, column, active):  # type: ignore[no-untyped-def]
    for i in prange(active.first_column, active.last_column + 1):
        if active.last_rows[i] >= active.first_rows[i]:
            start = i * column
            numbers[(start + active.first_rows[i]) * components : (start + active.last_rows[i] + 1) * components] = 0.0


@cache
def _make_update(axes: int) -> Callable[..., None]:
    of_mass, of_momentum, of_force, of_bulk = (
        NODE_OF[axes].mass,
        NODE_OF[axes].momentum,
        NODE_OF[axes].force,
        NODE_OF[axes].bulk,
    )

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{axes}_{CORE_MARK}")
    def update(nodes, bulk, column, active, gravity, dt, couples):  # type: ignore[no-untyped-def]
        for i in prange(active.first_column, active.last_column + 1):
            for number in range(i * column + active.first_rows[i], i * column + active.last_rows[i] + 1):
                node = np.uint64(number * COMPONENTS)
                mass = nodes[node + np.uint64(of_mass)]
                if mass > 0.0:
                    per_mass = 1.0 / mass
                    for axis in range(axes):
                        momentum, force = node + np.uint64(of_momentum + axis), node + np.uint64(of_force + axis)
                        old, push = nodes[momentum] * per_mass, nodes[force] * per_mass
                        nodes[momentum], nodes[force] = old + dt * push + dt * gravity[axis], old
                    if couples and axes == 2:
                        _average(nodes, node + np.uint64(of_bulk), mass)
                    elif couples:
                        _average(bulk, np.uint64(number * BULK_COMPONENTS), mass)

    return update


@register_jitable(forceinline=True)
def _average(numbers, at, mass):  # type: ignore[no-untyped-def]
    """Turn volume and volume times pressure into pressure and density."""
    per_volume = 1.0 / numbers[at]
    numbers[at] = numbers[at + np.uint64(1)] * per_volume
    numbers[at + np.uint64(1)] = mass * per_volume
