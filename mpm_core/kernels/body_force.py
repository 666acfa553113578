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
from grainlaw.mpm_core.grid.grid import COMPONENTS, FX, FY, Grid
from grainlaw.mpm_core.kernels.shape_functions import Basis, make_stencil
from grainlaw.mpm_core.kernels.sources import CORE_MARK

# (body, time [s]) -> acceleration [m/s2] of its points in their present order, shape (2, n)
BodyForce = Callable[[Body, float], NDArray[np.float64]]


def scatter_body_force(body: Body, acceleration: NDArray[np.float64], grid: Grid, basis: Basis) -> None:
    """Add w_i m b of each point to the forces of the nodes."""
    _make_scatter(basis)(
        *body.positions,
        body.point_mass * acceleration,
        grid.nodes,
        grid.shape[1],
        grid.ghosts,
        *grid.origin,
        grid.cell_size,
    )


@cache
def _make_scatter(basis: Basis) -> Callable[..., Any]:
    width, stencil = basis.width, make_stencil(basis)

    @njit(cache=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def scatter(x, y, force, nodes, nodes_y, ghosts, origin_x, origin_y, cell_size):  # type: ignore[no-untyped-def]
        for p in range(len(x)):
            i, _, wx, _, _ = stencil((x[p] - origin_x) / cell_size, ghosts[0], ghosts[1])
            j, _, wy, _, _ = stencil((y[p] - origin_y) / cell_size, ghosts[2], ghosts[3])
            for a in range(width):
                for b in range(width):
                    node = ((int(i) + a) * nodes_y + int(j) + b) * COMPONENTS
                    nodes[node + FX] += wx[a] * wy[b] * force[0, p]
                    nodes[node + FY] += wx[a] * wy[b] * force[1, p]

    return scatter
