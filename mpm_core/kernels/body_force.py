"""A force on the points that a program prescribes: acceleration as a function of body and time.

It is no part of a scene file; manufactured solutions set `Simulation.body_force`.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.grid import COMPONENTS, NODE_OF, Grid
from grainlaw.mpm_core.kernels.shape_functions import Basis, make_stencil
from grainlaw.mpm_core.kernels.sources import CORE_MARK

# (body, time [s]) -> acceleration [m/s2] of its points in their present order, shape (axes, n)
BodyForce = Callable[[Body, float], NDArray[np.float64]]


def scatter_body_force(body: Body, acceleration: NDArray[np.float64], grid: Grid, basis: Basis) -> None:
    """Add w_i m b of each point to the forces of the nodes."""
    force = body.masses * acceleration
    scatter = _make_scatter(basis, grid.space.axes)
    scatter(body.positions, force, grid.nodes, grid.strides, grid.ghosts, grid.origin, grid.cell_size)


@cache
def _make_scatter(basis: Basis, axes: int) -> Callable[..., Any]:
    width, stencil, force_component = basis.width, make_stencil(basis), NODE_OF[axes].force
    nodes_of_stencil = width**axes

    @njit(cache=True)
    @named(f"{basis.name}_{axes}_{CORE_MARK}")
    def scatter(positions, force, nodes, strides, ghosts, origin, cell_size):  # type: ignore[no-untyped-def]
        weights, first = np.empty((axes, width)), np.empty(axes, np.int64)
        for p in range(positions.shape[1]):
            for axis in range(axes):
                coordinate = (positions[axis, p] - origin[axis]) / cell_size
                number, _, of_axis, _, _ = stencil(coordinate, ghosts[2 * axis], ghosts[2 * axis + 1])
                first[axis] = int(number)
                for a in range(width):
                    weights[axis, a] = of_axis[a]
            for k in range(nodes_of_stencil):
                weight, node, rest = 1.0, 0, k
                for axis in range(axes):
                    weight *= weights[axis, rest % width]
                    node += (first[axis] + rest % width) * strides[axis]
                    rest //= width
                for axis in range(axes):
                    nodes[node * COMPONENTS + force_component + axis] += weight * force[axis, p]

    return scatter
