"""The momentum equation on the grid: m dv/dt = f + m g."""

from collections.abc import Callable
from functools import cache
from typing import Any

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


def update_nodes(grid: Grid, active: ActiveNodes, gravity: tuple[float, ...], dt: float, couples: bool) -> float:
    """Turn what was scattered into old velocity and new velocity v + dt (f/m + g) [m/s].

    If `couples`, turn the volumes and pressures as well, into the averages that `volume_coupling` takes.
    Returns the work of the forces, internal ones and gravity, on the nodes [J and the space's amount]: impulse times
    the mean of old and new velocity.
    """
    update = _make_update(grid.space.axes)
    works = update(grid.nodes, grid.bulk, grid.shape[-1], active.columns, grid.counted, gravity, dt, couples)
    return sum_of_columns(works)


def sum_of_columns(works: NDArray[np.float64]) -> float:
    """The sum of what each column of nodes has, one after the other: columns without material change nothing in it."""
    return float(_sum(works))


@njit(parallel=True, cache=True)
@named(CORE_MARK)
def _clear(numbers, components, column, active):  # type: ignore[no-untyped-def]
    for i in prange(active.first_column, active.last_column + 1):
        if active.last_rows[i] >= active.first_rows[i]:
            start = i * column
            numbers[(start + active.first_rows[i]) * components : (start + active.last_rows[i] + 1) * components] = 0.0


@cache
def _make_update(axes: int) -> Callable[..., Any]:
    of_mass, of_momentum, of_force, of_bulk = (
        NODE_OF[axes].mass,
        NODE_OF[axes].momentum,
        NODE_OF[axes].force,
        NODE_OF[axes].bulk,
    )

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{axes}_{CORE_MARK}")
    def update(nodes, bulk, column, active, counted, gravity, dt, couples):  # type: ignore[no-untyped-def]
        works = np.zeros(active.last_column - active.first_column + 1)
        for i in prange(active.first_column, active.last_column + 1):
            twice_work, first, behind = 0.0, i * column + counted.first_row, i * column + counted.row_behind
            for number in range(i * column + active.first_rows[i], i * column + active.last_rows[i] + 1):
                node = np.uint64(number * COMPONENTS)
                mass = nodes[node + np.uint64(of_mass)]
                if mass > 0.0:
                    per_mass, twice_work_per_mass = 1.0 / mass, 0.0
                    for axis in range(axes):
                        momentum, force = node + np.uint64(of_momentum + axis), node + np.uint64(of_force + axis)
                        old, push = nodes[momentum] * per_mass, nodes[force] * per_mass
                        new = old + dt * push + dt * gravity[axis]
                        nodes[momentum], nodes[force] = new, old
                        twice_work_per_mass += (new - old) * (new + old)
                    if first <= number < behind:
                        twice_work += mass * twice_work_per_mass
                    if couples and axes == 2:
                        _average(nodes, node + np.uint64(of_bulk), mass)
                    elif couples:
                        _average(bulk, np.uint64(number * BULK_COMPONENTS), mass)
            works[i - active.first_column] = 0.5 * twice_work if counted.columns[i] else 0.0
        return works

    return update


@njit(cache=True)
@named(CORE_MARK)
def _sum(works):  # type: ignore[no-untyped-def]
    total = 0.0
    for work in works:
        total += work
    return total


@register_jitable(forceinline=True)
def _average(numbers, at, mass):  # type: ignore[no-untyped-def]
    """Turn volume and volume times pressure into pressure and density."""
    per_volume = 1.0 / numbers[at]
    numbers[at] = numbers[at + np.uint64(1)] * per_volume
    numbers[at + np.uint64(1)] = mass * per_volume
