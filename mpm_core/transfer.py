"""The two transfers of the Material Point Method. They know points, nodes and shape functions, but no law.

Affine particle-in-cell transfer (Jiang et al. 2015) with the moving-least-squares gradient (Hu et al. 2018): a point
brings the velocity field v + A (x - x_p) to the grid and takes the gradient L = sum_i w_i v_i (x_i - x_p)^T / D from
it. On top of it the point keeps what the grid did not resolve of its field, for a time constant tau:

    v <- sum_i w_i v_i^new + exp(-dt/tau) (v - sum_i w_i v_i^old)
    A <- L^new             + exp(-dt/tau) (A - L^old)

so that tau = 0 is APIC, tau = infinity affine FLIP, and the loss per second does not depend on the step. The energy of
a point's field is m/2 (v^2 + A:A D); for tau = infinity the transfers keep its sum, but for terms of the order of dt.

The grid also returns to each point pressure, density and crowding of the material around it, which tie the volumes of
points to one another, and points move a little slower or faster than the material where they crowd (`volumes`).

Points come in stripes of grid columns (`sorting`). Stripes of even number are scattered first, then those of odd
number: within each half no two stripes share a node, so that the sums come out the same for any number of threads.

All arithmetic is strict. Licence to contract or reorder it would save time, but code just compiled and the same code
loaded from the disk cache then differ in the last bit, and a resumed run would not repeat the bits.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import njit, prange

from materials.compilation import named
from materials.tensor import SymmetricTensor, shear_strain_rate
from mpm_core.basis import Basis, make_stencil
from mpm_core.columns import (
    AXX,
    AXY,
    AYX,
    AYY,
    CROWDING,
    DENSITY,
    LXX,
    LXY,
    LYX,
    LYY,
    MEAN_DENSITY,
    MEAN_PRESSURE,
    SXX,
    SXY,
    SYY,
    SZZ,
    VX,
    VY,
    X,
    Y,
)
from mpm_core.grid import (
    COMPONENTS,
    NEW_VX,
    NEW_VY,
    NODE_CROWDING,
    NODE_DENSITY,
    NODE_PRESSURE,
    OLD_VX,
    OLD_VY,
)
from mpm_core.lanes import LANES, deposit, lane, lanes, node_at, scaled_sum
from mpm_core.sources import CORE_MARK
from mpm_core.volumes import spreading_rate

BLOCK = 2048
ZEROS = (0.0,) * LANES

# What `grid_to_points` reports for each block of points.
KINETIC_ENERGY, LOWEST_X, HIGHEST_X, LOWEST_Y, HIGHEST_Y, MAX_SPEED, MOVED_X, MOVED_Y = range(8)
REPORTS = 8


@cache
def make_points_to_grid(basis: Basis) -> Callable[..., Any]:
    """Scatter mass, volume, momentum, internal force and pressure of the stripes of one parity to the grid.

    m_i += w_i m;  V_i += w_i V;  (V p)_i += w_i V p;
    (m v)_i += w_i m (v + A (x_i - x_p));  f_i -= w_i V sigma (x_i - x_p) / D
    """
    width, stencil = basis.width, make_stencil(basis)

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def points_to_grid(  # type: ignore[no-untyped-def]
        rows, point_mass, stripe_starts, chunks, parity, nodes, nodes_y, ghosts, origin_x, origin_y, cell_size
    ):
        x, y, vx, vy = rows[X], rows[Y], rows[VX], rows[VY]
        axx, axy, ayx, ayy = rows[AXX], rows[AXY], rows[AYX], rows[AYY]
        sxx, syy, szz, sxy, density = rows[SXX], rows[SYY], rows[SZZ], rows[SXY], rows[DENSITY]
        inverse_size = 1.0 / cell_size
        affine = point_mass * cell_size
        for chunk in prange(chunks.shape[0] - 1):
            for stripe in range(chunks[chunk] + (chunks[chunk] + parity) % 2, chunks[chunk + 1], 2):
                for p in range(np.uint64(stripe_starts[stripe]), np.uint64(stripe_starts[stripe + 1])):
                    i, fx, wx, inverse_x = stencil((x[p] - origin_x) * inverse_size, ghosts[0], ghosts[1])
                    j, fy, wy, inverse_y = stencil((y[p] - origin_y) * inverse_size, ghosts[2], ghosts[3])
                    volume = point_mass / density[p]
                    force_x = -volume * inverse_size * inverse_x
                    force_y = -volume * inverse_size * inverse_y
                    pressure = (sxx[p] + syy[p] + szz[p]) * (-1.0 / 3.0)
                    momentum_x, momentum_y = point_mass * vx[p], point_mass * vy[p]
                    here = lanes((point_mass, momentum_x, momentum_y, 0.0, 0.0, volume, volume * pressure, 0.0))
                    along_x = lanes(
                        (0.0, affine * axx[p], affine * ayx[p], force_x * sxx[p], force_x * sxy[p], 0.0, 0.0, 0.0)
                    )
                    along_y = lanes(
                        (0.0, affine * axy[p], affine * ayy[p], force_y * sxy[p], force_y * syy[p], 0.0, 0.0, 0.0)
                    )
                    for a in range(width):
                        row = np.uint64(((i + a) * nodes_y + j) * COMPONENTS)
                        in_row = scaled_sum(a - fx, along_x, here)
                        for b in range(width):
                            amounts = scaled_sum(b - fy, along_y, in_row)
                            deposit(nodes, row + np.uint64(b * COMPONENTS), wx[a] * wy[b], amounts)

    return points_to_grid


@cache
def make_grid_to_points(basis: Basis) -> Callable[..., Any]:
    """Gather velocity, its gradient and averages of the material around from the grid, and move the points.

    `memory` is exp(-dt/tau), `spreads` whether points move down the gradient of crowding. Reports per block of points:
    kinetic energy [J/m], corners of the bounding box [m], the largest speed at which a point moves [m/s] and the
    momentum of that motion [kg/s].
    """
    width, stencil = basis.width, make_stencil(basis)

    @njit(parallel=True, error_model="numpy", cache=True)
    @named(f"{basis.name}_{CORE_MARK}")
    def grid_to_points(  # type: ignore[no-untyped-def]
        rows, point_mass, nodes, nodes_y, ghosts, origin_x, origin_y, cell_size, dt, memory, spreads, reports
    ):
        x, y, vx, vy = rows[X], rows[Y], rows[VX], rows[VY]
        lxx, lxy, lyx, lyy = rows[LXX], rows[LXY], rows[LYX], rows[LYY]
        axx, axy, ayx, ayy = rows[AXX], rows[AXY], rows[AYX], rows[AYY]
        mean_density, mean_pressure, crowding = rows[MEAN_DENSITY], rows[MEAN_PRESSURE], rows[CROWDING]
        inverse_size = 1.0 / cell_size
        square = cell_size * cell_size
        count = len(x)
        zero = lanes(ZEROS)
        for block in prange(reports.shape[0]):
            twice_energy = 0.0
            lowest_x, highest_x, lowest_y, highest_y = np.inf, -np.inf, np.inf, -np.inf
            fastest, moved_x, moved_y = 0.0, 0.0, 0.0
            for p in range(np.uint64(block * BLOCK), np.uint64(min(count, (block + 1) * BLOCK))):
                i, fx, wx, inverse_x = stencil((x[p] - origin_x) * inverse_size, ghosts[0], ghosts[1])
                j, fy, wy, inverse_y = stencil((y[p] - origin_y) * inverse_size, ghosts[2], ghosts[3])
                mean, slope_x, slope_y = zero, zero, zero
                for a in range(width):
                    row = np.uint64(((i + a) * nodes_y + j) * COMPONENTS)
                    in_row, along_row = zero, zero
                    for b in range(width):
                        node = node_at(nodes, row + np.uint64(b * COMPONENTS))
                        in_row = scaled_sum(wy[b], node, in_row)
                        along_row = scaled_sum(wy[b] * (b - fy), node, along_row)
                    mean = scaled_sum(wx[a], in_row, mean)
                    slope_x = scaled_sum(wx[a] * (a - fx), in_row, slope_x)
                    slope_y = scaled_sum(wx[a], along_row, slope_y)
                scale_x, scale_y = inverse_size * inverse_x, inverse_size * inverse_y
                lxx[p], lxy[p] = lane(slope_x, NEW_VX) * scale_x, lane(slope_y, NEW_VX) * scale_y
                lyx[p], lyy[p] = lane(slope_x, NEW_VY) * scale_x, lane(slope_y, NEW_VY) * scale_y
                axx[p] = lxx[p] + memory * (axx[p] - lane(slope_x, OLD_VX) * scale_x)
                axy[p] = lxy[p] + memory * (axy[p] - lane(slope_y, OLD_VX) * scale_y)
                ayx[p] = lyx[p] + memory * (ayx[p] - lane(slope_x, OLD_VY) * scale_x)
                ayy[p] = lyy[p] + memory * (ayy[p] - lane(slope_y, OLD_VY) * scale_y)
                mean_density[p], mean_pressure[p] = lane(mean, NODE_DENSITY), lane(mean, NODE_PRESSURE)
                crowding[p] = lane(mean, NODE_CROWDING)
                new_vx, new_vy = lane(mean, NEW_VX), lane(mean, NEW_VY)
                old_vx, old_vy = lane(mean, OLD_VX), lane(mean, OLD_VY)
                velocity_x = new_vx + memory * (vx[p] - old_vx)
                velocity_y = new_vy + memory * (vy[p] - old_vy)
                vx[p], vy[p] = velocity_x, velocity_y
                if spreads:
                    motion = SymmetricTensor(lxx[p], lyy[p], 0.0, 0.5 * (lxy[p] + lyx[p]), 0.0, 0.0)
                    spreading = cell_size * spreading_rate(shear_strain_rate(motion), dt)
                    new_vx -= spreading * lane(slope_x, NODE_CROWDING)
                    new_vy -= spreading * lane(slope_y, NODE_CROWDING)
                new_x, new_y = x[p] + dt * new_vx, y[p] + dt * new_vy
                x[p], y[p] = new_x, new_y
                along_x = axx[p] * axx[p] + ayx[p] * ayx[p]
                along_y = axy[p] * axy[p] + ayy[p] * ayy[p]
                twice_energy += velocity_x * velocity_x + velocity_y * velocity_y
                twice_energy += square * (along_x * inverse_y + along_y * inverse_x) / (inverse_x * inverse_y)
                moved_squared = new_vx * new_vx + new_vy * new_vy
                moved_x, moved_y = moved_x + new_vx, moved_y + new_vy
                fastest = max(fastest, moved_squared)
                lowest_x, highest_x = min(lowest_x, new_x), max(highest_x, new_x)
                lowest_y, highest_y = min(lowest_y, new_y), max(highest_y, new_y)
            reports[block, KINETIC_ENERGY] = 0.5 * point_mass * twice_energy
            reports[block, LOWEST_X], reports[block, HIGHEST_X] = lowest_x, highest_x
            reports[block, LOWEST_Y], reports[block, HIGHEST_Y] = lowest_y, highest_y
            reports[block, MAX_SPEED] = np.sqrt(fastest)
            reports[block, MOVED_X], reports[block, MOVED_Y] = point_mass * moved_x, point_mass * moved_y

    return grid_to_points
