"""The yardstick in three dimensions: that of `yardstick`, with one axis more and the same liberties.

One explicit step of MLS-MPM with quadratic B-splines, the affine transfer APIC, a friction floor, smooth side walls,
and the adaptive step of the library, as a competent first attempt in numba would write it: one point at a time, in the
order in which the points were generated, four values per node, one thread, `fastmath`.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit

from benchmarks.yardstick import PADDING, Kernels, Yardstick, quadratic, row_as_tuple
from grainlaw.materials.compilation import PointwiseLaw, mark_of_sources, named
from grainlaw.materials.tensor import SymmetricTensor

MARK = mark_of_sources([Path(__file__), Path(__file__).with_name("yardstick.py")])


@njit(cache=True, error_model="numpy", fastmath=True)
@named(MARK)
def points_to_grid(x, v, c, stress, density, point_mass, grid_m, grid_v, h, dt):  # type: ignore[no-untyped-def]
    """Scatter mass and momentum; the impulse of the stress travels with the affine momentum."""
    for p in range(len(x)):
        i, j, n = int(x[p, 0] / h - 0.5), int(x[p, 1] / h - 0.5), int(x[p, 2] / h - 0.5)
        fx, fy, fz = x[p, 0] / h - i, x[p, 1] / h - j, x[p, 2] / h - n
        wx, wy, wz = quadratic(fx), quadratic(fy), quadratic(fz)
        xx, yy, zz, xy, yz, xz = stress[p, 0], stress[p, 1], stress[p, 2], stress[p, 3], stress[p, 4], stress[p, 5]
        k, m = -4.0 * dt * point_mass / (density[p] * h * h), point_mass
        axx, axy, axz = k * xx + m * c[p, 0], k * xy + m * c[p, 1], k * xz + m * c[p, 2]
        ayx, ayy, ayz = k * xy + m * c[p, 3], k * yy + m * c[p, 4], k * yz + m * c[p, 5]
        azx, azy, azz = k * xz + m * c[p, 6], k * yz + m * c[p, 7], k * zz + m * c[p, 8]
        for a in range(3):
            for b in range(3):
                for d in range(3):
                    dx, dy, dz = (a - fx) * h, (b - fy) * h, (d - fz) * h
                    w = wx[a] * wy[b] * wz[d]
                    grid_m[i + a, j + b, n + d] += w * m
                    grid_v[i + a, j + b, n + d, 0] += w * (m * v[p, 0] + axx * dx + axy * dy + axz * dz)
                    grid_v[i + a, j + b, n + d, 1] += w * (m * v[p, 1] + ayx * dx + ayy * dy + ayz * dz)
                    grid_v[i + a, j + b, n + d, 2] += w * (m * v[p, 2] + azx * dx + azy * dy + azz * dz)


@njit(cache=True, error_model="numpy", fastmath=True)
@named(MARK)
def update_grid(grid_m, grid_v, gravity, friction, dt):  # type: ignore[no-untyped-def]
    """Momentum to velocity, gravity, friction at and below the floor, smooth walls."""
    last_x, last_y = grid_m.shape[0] - 1 - PADDING, grid_m.shape[1] - 1 - PADDING
    for i in range(grid_m.shape[0]):
        for j in range(grid_m.shape[1]):
            for n in range(grid_m.shape[2]):
                if grid_m[i, j, n] > 0.0:
                    vx = grid_v[i, j, n, 0] / grid_m[i, j, n] + dt * gravity[0]
                    vy = grid_v[i, j, n, 1] / grid_m[i, j, n] + dt * gravity[1]
                    vz = grid_v[i, j, n, 2] / grid_m[i, j, n] + dt * gravity[2]
                    if n <= PADDING and vz < 0.0:
                        speed = np.sqrt(vx * vx + vy * vy)
                        share = max(0.0, speed + friction * vz) / speed if speed > 0.0 else 0.0
                        vx, vy, vz = share * vx, share * vy, 0.0
                    if (i <= PADDING and vx < 0.0) or (i >= last_x and vx > 0.0):
                        vx = 0.0
                    if (j <= PADDING and vy < 0.0) or (j >= last_y and vy > 0.0):
                        vy = 0.0
                    grid_v[i, j, n, 0], grid_v[i, j, n, 1], grid_v[i, j, n, 2] = vx, vy, vz


@njit(cache=True, error_model="numpy", fastmath=True)
@named(MARK)
def grid_to_points(x, v, c, grid_v, h, dt):  # type: ignore[no-untyped-def]
    """Gather velocity and its gradient, move the points."""
    k = 4.0 / h
    for p in range(len(x)):
        i, j, n = int(x[p, 0] / h - 0.5), int(x[p, 1] / h - 0.5), int(x[p, 2] / h - 0.5)
        fx, fy, fz = x[p, 0] / h - i, x[p, 1] / h - j, x[p, 2] / h - n
        wx, wy, wz = quadratic(fx), quadratic(fy), quadratic(fz)
        vx, vy, vz = 0.0, 0.0, 0.0
        cxx, cxy, cxz, cyx, cyy, cyz, czx, czy, czz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for a in range(3):
            for b in range(3):
                for d in range(3):
                    w = wx[a] * wy[b] * wz[d]
                    ux = w * grid_v[i + a, j + b, n + d, 0]
                    uy = w * grid_v[i + a, j + b, n + d, 1]
                    uz = w * grid_v[i + a, j + b, n + d, 2]
                    vx, vy, vz = vx + ux, vy + uy, vz + uz
                    cxx, cxy, cxz = cxx + ux * (a - fx), cxy + ux * (b - fy), cxz + ux * (d - fz)
                    cyx, cyy, cyz = cyx + uy * (a - fx), cyy + uy * (b - fy), cyz + uy * (d - fz)
                    czx, czy, czz = czx + uz * (a - fx), czy + uz * (b - fy), czz + uz * (d - fz)
        v[p, 0], v[p, 1], v[p, 2] = vx, vy, vz
        c[p, 0], c[p, 1], c[p, 2] = k * cxx, k * cxy, k * cxz
        c[p, 3], c[p, 4], c[p, 5] = k * cyx, k * cyy, k * cyz
        c[p, 6], c[p, 7], c[p, 8] = k * czx, k * czy, k * czz
        x[p, 0] += dt * vx
        x[p, 1] += dt * vy
        x[p, 2] += dt * vz


@cache
def make_update_stress(law: PointwiseLaw) -> Callable[..., Any]:
    """The loop over all points that calls a law; returns the largest signal speed c + |v| [m/s]."""
    update, sound_speed, state_class, parameter_class = law.update, law.sound_speed, law.state, law.parameters
    count = len(state_class._fields)

    @njit(cache=True, error_model="numpy", fastmath=True)
    @named(f"{law.mark}_{MARK}")
    def update_stress(v, c, stress, density, states, parameters, dt):  # type: ignore[no-untyped-def]
        law_parameters = parameter_class(*parameters)
        fastest = 0.0
        for p in range(len(v)):
            xx, yy, zz, xy, yz, xz = stress[p, 0], stress[p, 1], stress[p, 2], stress[p, 3], stress[p, 4], stress[p, 5]
            # Jaumann's rate: W sigma - sigma W
            a, b = 0.5 * dt * (c[p, 1] - c[p, 3]), 0.5 * dt * (c[p, 5] - c[p, 7])
            d = 0.5 * dt * (c[p, 2] - c[p, 6])
            rotated = SymmetricTensor(
                xx + 2.0 * (a * xy + d * xz),
                yy + 2.0 * (b * yz - a * xy),
                zz - 2.0 * (d * xz + b * yz),
                xy + a * (yy - xx) + d * yz + b * xz,
                yz + b * (zz - yy) - a * xz - d * xy,
                xz + d * (zz - xx) + a * yz - b * xy,
            )
            shear_xy, shear_yz = 0.5 * (c[p, 1] + c[p, 3]), 0.5 * (c[p, 5] + c[p, 7])
            shear_xz = 0.5 * (c[p, 2] + c[p, 6])
            strain_rate = SymmetricTensor(c[p, 0], c[p, 4], c[p, 8], shear_xy, shear_yz, shear_xz)
            density[p] /= 1.0 + dt * (c[p, 0] + c[p, 4] + c[p, 8])
            state = state_class(*row_as_tuple(states, p, count))
            new, state = update(rotated, strain_rate, density[p], state, law_parameters, dt)
            stress[p, 0], stress[p, 1], stress[p, 2] = new.xx, new.yy, new.zz
            stress[p, 3], stress[p, 4], stress[p, 5] = new.xy, new.yz, new.xz
            for k in range(count):
                states[p, k] = state[k]
            speed = np.sqrt(v[p, 0] * v[p, 0] + v[p, 1] * v[p, 1] + v[p, 2] * v[p, 2])
            fastest = max(fastest, speed + sound_speed(new, density[p], state, law_parameters))
        return fastest

    return update_stress


class Yardstick3D(Yardstick):
    """The yardstick of a simulation in three dimensions."""

    kernels = Kernels(points_to_grid, update_grid, grid_to_points, make_update_stress)
