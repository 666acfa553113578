"""The yardstick: the Material Point Method as a competent first attempt in numba would write it.

What it does: one explicit step of MLS-MPM (Hu et al. 2018) in plane strain, with quadratic B-splines, the affine
transfer APIC, a friction floor, smooth side walls, and the adaptive step of the library. It calls the very functions of
the library's laws, compiled, and starts from the library's points. One thread, `fastmath`.

What a first attempt does not do, and neither does this: sort points, keep each quantity in an array of its own, store
anything between the passes that the next step can do without.

What it saves against the library, so that the ratio is rather too hard than too kind: three values per node in place of
eight (it neither keeps the unresolved velocity nor couples the volumes of points), Jaumann's rate to first
order for the rotation, no energies, no shear strain, no check of any result, no walls between nodes, one body, no
frames.

It is a program to be timed, not one to be used: it loses energy with every step, as APIC does.
"""

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numba.np.unsafe.ndarray import to_fixed_tuple

from grainlaw.materials.compilation import PointwiseLaw, mark_of_sources, named, pointwise_law
from grainlaw.materials.tensor import SymmetricTensor
from grainlaw.mpm_core.simulation import Simulation

# Nodes between the edge of the grid and the walls.
PADDING = 3
MARK = mark_of_sources([Path(__file__)])


@register_jitable
def quadratic(f):  # type: ignore[no-untyped-def]
    """Weights of the three nodes around a point, f in [1/2, 3/2) from the first."""
    return 0.5 * (1.5 - f) ** 2, 0.75 - (f - 1.0) ** 2, 0.5 * (f - 0.5) ** 2


@njit(cache=True, error_model="numpy", fastmath=True)
@named(MARK)
def points_to_grid(x, v, c, stress, density, point_mass, grid_m, grid_v, h, dt):  # type: ignore[no-untyped-def]
    """Scatter mass and momentum; the impulse of the stress travels with the affine momentum."""
    for p in range(len(x)):
        i, j = int(x[p, 0] / h - 0.5), int(x[p, 1] / h - 0.5)
        fx, fy = x[p, 0] / h - i, x[p, 1] / h - j
        wx, wy = quadratic(fx), quadratic(fy)
        k = -4.0 * dt * point_mass / (density[p] * h * h)
        axx, axy = k * stress[p, 0] + point_mass * c[p, 0], k * stress[p, 3] + point_mass * c[p, 1]
        ayx, ayy = k * stress[p, 3] + point_mass * c[p, 2], k * stress[p, 1] + point_mass * c[p, 3]
        for a in range(3):
            for b in range(3):
                dx, dy = (a - fx) * h, (b - fy) * h
                w = wx[a] * wy[b]
                grid_m[i + a, j + b] += w * point_mass
                grid_v[i + a, j + b, 0] += w * (point_mass * v[p, 0] + axx * dx + axy * dy)
                grid_v[i + a, j + b, 1] += w * (point_mass * v[p, 1] + ayx * dx + ayy * dy)


@njit(cache=True, error_model="numpy", fastmath=True)
@named(MARK)
def update_grid(grid_m, grid_v, gravity, friction, dt):  # type: ignore[no-untyped-def]
    """Momentum to velocity, gravity, friction at and below the floor, smooth walls."""
    for i in range(grid_m.shape[0]):
        for j in range(grid_m.shape[1]):
            if grid_m[i, j] > 0.0:
                vx = grid_v[i, j, 0] / grid_m[i, j] + dt * gravity[0]
                vy = grid_v[i, j, 1] / grid_m[i, j] + dt * gravity[1]
                if j <= PADDING and vy < 0.0:
                    vx = np.copysign(max(0.0, abs(vx) + friction * vy), vx)
                    vy = 0.0
                if (i <= PADDING and vx < 0.0) or (i >= grid_m.shape[0] - 1 - PADDING and vx > 0.0):
                    vx = 0.0
                grid_v[i, j, 0], grid_v[i, j, 1] = vx, vy


@njit(cache=True, error_model="numpy", fastmath=True)
@named(MARK)
def grid_to_points(x, v, c, grid_v, h, dt):  # type: ignore[no-untyped-def]
    """Gather velocity and its gradient, move the points."""
    for p in range(len(x)):
        i, j = int(x[p, 0] / h - 0.5), int(x[p, 1] / h - 0.5)
        fx, fy = x[p, 0] / h - i, x[p, 1] / h - j
        wx, wy = quadratic(fx), quadratic(fy)
        vx, vy, cxx, cxy, cyx, cyy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for a in range(3):
            for b in range(3):
                ux = wx[a] * wy[b] * grid_v[i + a, j + b, 0]
                uy = wx[a] * wy[b] * grid_v[i + a, j + b, 1]
                vx, vy = vx + ux, vy + uy
                cxx, cxy = cxx + ux * (a - fx), cxy + ux * (b - fy)
                cyx, cyy = cyx + uy * (a - fx), cyy + uy * (b - fy)
        k = 4.0 / h
        v[p, 0], v[p, 1] = vx, vy
        c[p, 0], c[p, 1], c[p, 2], c[p, 3] = k * cxx, k * cxy, k * cyx, k * cyy
        x[p, 0] += dt * vx
        x[p, 1] += dt * vy


@register_jitable
def row_as_tuple(states, p, count):  # type: ignore[no-untyped-def]
    """A row of an array as a tuple, of which a law's state is made."""
    return to_fixed_tuple(states[p], count)  # type: ignore[call-arg]


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
            xx, yy, zz, xy = stress[p, 0], stress[p, 1], stress[p, 2], stress[p, 3]
            spin = 0.5 * dt * (c[p, 2] - c[p, 1])
            rotated = SymmetricTensor(xx - 2.0 * spin * xy, yy + 2.0 * spin * xy, zz, xy + spin * (xx - yy), 0.0, 0.0)
            strain_rate = SymmetricTensor(c[p, 0], c[p, 3], 0.0, 0.5 * (c[p, 1] + c[p, 2]), 0.0, 0.0)
            density[p] /= 1.0 + dt * (c[p, 0] + c[p, 3])
            state = state_class(*row_as_tuple(states, p, count))
            new, state = update(rotated, strain_rate, density[p], state, law_parameters, dt)
            stress[p, 0], stress[p, 1], stress[p, 2], stress[p, 3] = new.xx, new.yy, new.zz, new.xy
            for k in range(count):
                states[p, k] = state[k]
            speed = np.sqrt(v[p, 0] * v[p, 0] + v[p, 1] * v[p, 1])
            fastest = max(fastest, speed + sound_speed(new, density[p], state, law_parameters))
        return fastest

    return update_stress


class Kernels(NamedTuple):
    """The passes of a step."""

    points_to_grid: Callable[..., None]
    update_grid: Callable[..., None]
    grid_to_points: Callable[..., None]
    make_update_stress: Callable[[PointwiseLaw], Callable[..., Any]]


class Yardstick:
    """The points of a library's simulation of one body, as plain arrays, and a grid over its whole domain."""

    kernels = Kernels(points_to_grid, update_grid, grid_to_points, make_update_stress)

    def __init__(self, simulation: Simulation) -> None:
        scene, body = simulation.scene, simulation.bodies[0]
        self.h, self.safety, self.gravity = scene.grid.cell_size, scene.time.safety, scene.gravity
        self.friction = scene.boundary.bottom.coefficient
        self.lower = np.array(scene.grid.lower) - PADDING * self.h
        self.x = np.ascontiguousarray(body.positions.T) - self.lower
        self.v = np.ascontiguousarray(body.velocity.T)
        self.c = np.zeros((body.count, self.x.shape[1] ** 2))
        self.stress = np.ascontiguousarray(body.stress.T)
        self.density = body.density.copy()
        self.states = np.ascontiguousarray(body.states.T)
        self.point_mass, self.parameters = body.point_mass, tuple(body.parameters)
        shape = tuple(cells + 1 + 2 * PADDING for cells in scene.grid.cells)
        self.grid_m, self.grid_v = np.zeros(shape), np.zeros((*shape, len(shape)))
        self.update_stress = self.kernels.make_update_stress(pointwise_law(body.law))
        self.signal_speed, self.time, self.steps = simulation.signal_speed, 0.0, 0
        self.last_step = 0.0
        self.wave_factor = simulation.signal_bounds[0].wave_factor

    def critical_time_step(self) -> float:
        """The largest stable step [s]: a cell over the fastest signal."""
        return self.h / max(self.signal_speed, (math.hypot(*self.gravity) * self.h) ** 0.5)

    def step(self, dt: float) -> None:
        """Advance by dt [s]; as in the library, forces act from the middle of the last step to that of this."""
        kick = 0.5 * (self.last_step + dt)
        self.grid_m[:] = 0.0
        self.grid_v[:] = 0.0
        state, place = (self.x, self.v, self.c), (self.grid_m, self.grid_v, self.h)
        self.kernels.points_to_grid(*state, self.stress, self.density, self.point_mass, *place, kick)
        self.kernels.update_grid(self.grid_m, self.grid_v, self.gravity, self.friction, kick)
        self.kernels.grid_to_points(*state, self.grid_v, self.h, dt)
        self.signal_speed = self.wave_factor * self.update_stress(
            self.v, self.c, self.stress, self.density, self.states, self.parameters, dt
        )
        self.time += dt
        self.last_step = dt
        self.steps += 1

    def advance_to(self, target: float) -> None:
        """Step to a time [s], with the library's rule for the step."""
        while self.time < target:
            largest = self.safety * self.critical_time_step()
            count = max(1, int(np.ceil((target - self.time) / largest)))
            self.step((target - self.time) / count)
            self.time = target if count == 1 else self.time
