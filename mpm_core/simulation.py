"""The state of a run and one step of it. The step reads as the algorithm."""

import math
import time
from dataclasses import dataclass, replace

import numpy as np

from materials import SimulationError
from mpm_core import momentum
from mpm_core.basis import BASES
from mpm_core.body import Body
from mpm_core.body_force import BodyForce, scatter_body_force
from mpm_core.boundary import SIDES, Wall, WallKind, hold_at_wall, join_periodic
from mpm_core.columns import LXX, LYY, X, Y
from mpm_core.fields import chosen_fields
from mpm_core.grid import Grid, Window
from mpm_core.held_nodes import hold_nodes
from mpm_core.initial import build_bodies
from mpm_core.scene import Scene
from mpm_core.sorting import LONGEST_DRIFT
from mpm_core.stress import INTERNAL_WORK, MAX_INCREMENT, MAX_SIGNAL_SPEED
from mpm_core.threads import use_threads
from mpm_core.transfer import (
    HIGHEST_X,
    HIGHEST_Y,
    KINETIC_ENERGY,
    LOWEST_X,
    LOWEST_Y,
    MAX_SPEED,
    MOVED_X,
    MOVED_Y,
)

# A volumetric strain increment beyond which no explicit step can be right.
LARGEST_INCREMENT = 0.5


@dataclass
class Ledger:
    """Energies per width [J/m]: potential energy relative to the start, works since the start."""

    kinetic: float
    initial_kinetic: float
    potential: float = 0.0
    internal_work: float = 0.0
    wall_work: float = 0.0

    @property
    def numerical_dissipation(self) -> float:
        """What is left of the balance: energy that transfers and time integration took (or gave, if negative)."""
        return self.initial_kinetic - self.kinetic - self.potential - self.internal_work - self.wall_work


class Simulation:
    """Bodies, grid and walls of a scene, and the clock.

    What a program may set besides the scene: `body_force`, which acts besides gravity, and `held_nodes`, where the
    material is held. Their work is no part of the ledger.
    Raises InputError for a scene that cannot be built and for a law that does not compile.
    """

    def __init__(self, scene: Scene, threads: int = 1) -> None:
        self.scene = scene
        self.threads = threads
        use_threads(threads)
        self.basis = BASES[scene.transfer.basis]
        self.periodic_axes = _periodic_axes(scene)
        size = (scene.grid.lower, scene.grid.cells, scene.grid.cell_size)
        self.grid = Grid(*size, self.periodic_axes, self.basis.wall_room)
        self.bodies = build_bodies(scene)
        self.fields = chosen_fields(scene.output.fields, [body.law for body in self.bodies])
        started = time.perf_counter()
        for body in self.bodies:
            body.choose_kernels(self.basis, keeps_shear_strain="shear_strain" in self.fields)
        self.build_time = time.perf_counter() - started
        self.walls = _walls(scene)
        self.body_force: BodyForce | None = None
        self.held_nodes = np.empty(0, np.int64)
        self.time = 0.0
        self.steps = 0
        self.drift = math.inf
        corners = [body.corners() for body in self.bodies]
        lower, upper = np.min(corners, axis=0)[0], np.max(corners, axis=0)[1]
        self.window = self._window_of((lower[0], lower[1]), (upper[0], upper[1]))
        kinetic = sum(0.5 * body.point_mass * float((body.velocities**2).sum()) for body in self.bodies)
        self.ledger = Ledger(kinetic, kinetic)
        self.signal_speed = self._at_least_free_fall(max(body.largest_signal_speed() for body in self.bodies))

    def step(self, dt: float) -> None:
        """Advance by dt [s]. Raises SimulationError naming the point where the result cannot be right."""
        grid, window = self.grid, self.window
        self._sort_if_drifted()
        momentum.clear(grid, window)
        for body in self.bodies:
            body.to_grid(grid)
            if self.body_force is not None:
                scatter_body_force(body, self.body_force(body, self.time), grid, self.basis)
        for axis in self.periodic_axes:
            join_periodic(grid.nodes, grid, axis)
        momentum.update_velocities(grid, window, self.scene.gravity, dt)
        for wall in self.walls:
            self.ledger.wall_work += hold_at_wall(grid, wall, window)
        hold_nodes(grid, self.held_nodes)
        for body in self.bodies:
            body.from_grid(grid, dt, self._memory(dt))
        for body in self.bodies:
            body.update_stress(dt, dt / self.scene.transfer.time_constant)
        self.time += dt
        self.steps += 1
        self._take_reports(dt)

    def stable_step(self) -> float:
        """The largest stable step [s] at the present state: a cell over the fastest signal; infinite without any."""
        return self.grid.cell_size / self.signal_speed if self.signal_speed > 0.0 else math.inf

    def _memory(self, dt: float) -> float:
        """The share of the unresolved velocity that outlives a step."""
        transfer = self.scene.transfer
        return math.exp(-dt / transfer.time_constant) if transfer.scheme == "affine_flip" else 0.0

    def _sort_if_drifted(self) -> None:
        if self.drift > LONGEST_DRIFT * self.grid.cell_size:
            for body in self.bodies:
                for axis in self.periodic_axes:
                    body.wrap(axis, self.grid.lower[axis], self.grid.upper[axis] - self.grid.lower[axis])
                body.sort(self.grid, self.basis, self.window, self.threads)
            self.drift = 0.0

    def _take_reports(self, dt: float) -> None:
        for body in self.bodies:
            increment, speed = body.stress_reports[:, [MAX_INCREMENT, MAX_SIGNAL_SPEED]].max(axis=0)
            if not (increment < LARGEST_INCREMENT and speed < math.inf):
                self._fail_unsound(body, dt)
        reports = np.concatenate([body.transfer_reports for body in self.bodies])
        lower = (float(reports[:, LOWEST_X].min()), float(reports[:, LOWEST_Y].min()))
        upper = (float(reports[:, HIGHEST_X].max()), float(reports[:, HIGHEST_Y].max()))
        self._refuse_lost_points(lower, upper)
        self.window = self._window_of(lower, upper)
        self.drift += dt * float(reports[:, MAX_SPEED].max())
        stress = np.concatenate([body.stress_reports for body in self.bodies])
        self.signal_speed = self._at_least_free_fall(float(stress[:, MAX_SIGNAL_SPEED].max()))
        ledger = self.ledger
        ledger.kinetic = float(reports[:, KINETIC_ENERGY].sum())
        ledger.internal_work += float(stress[:, INTERNAL_WORK].sum())
        moved = (float(reports[:, MOVED_X].sum()), float(reports[:, MOVED_Y].sum()))
        ledger.potential -= dt * (self.scene.gravity[0] * moved[0] + self.scene.gravity[1] * moved[1])

    def _window_of(self, lower: tuple[float, float], upper: tuple[float, float]) -> Window:
        """The nodes in reach of points between two corners; all nodes along a periodic axis."""
        window = self.grid.window(lower, upper, self.basis.offset, self.basis.width)
        if 0 in self.periodic_axes:
            window = replace(window, first_x=0, last_x=self.grid.shape[0] - 1)
        if 1 in self.periodic_axes:
            window = replace(window, first_y=0, last_y=self.grid.shape[1] - 1)
        return window

    def _at_least_free_fall(self, speed: float) -> float:
        """A signal speed no less than that of a fall through one cell, for material without stiffness."""
        return max(speed, math.sqrt(math.hypot(*self.scene.gravity) * self.grid.cell_size))

    def _refuse_lost_points(self, lower: tuple[float, float], upper: tuple[float, float]) -> None:
        for axis in (0, 1):
            if axis in self.periodic_axes:
                continue
            if lower[axis] < self.grid.lower[axis] or upper[axis] > self.grid.upper[axis]:
                self._fail_outside(axis)

    def _fail_outside(self, axis: int) -> None:
        for body in self.bodies:
            coordinate = body.points[(X, Y)[axis]]
            outside = (coordinate < self.grid.lower[axis]) | (coordinate > self.grid.upper[axis])
            if outside.any():
                self._fail(body, int(np.argmax(outside)), "the point has left the domain")

    def _fail_unsound(self, body: Body, dt: float) -> None:
        finite = np.isfinite(body.points).all(axis=0)
        if not finite.all():
            self._fail(body, int(np.argmin(finite)), "the stress or another quantity is not finite")
        increments = dt * np.abs(body.points[LXX] + body.points[LYY])
        worst = int(np.argmax(increments))
        if increments[worst] < LARGEST_INCREMENT:
            self._fail(body, worst, "the law's sound speed is not finite")
        self._fail(body, worst, f"its volume changed by {increments[worst]:.0%} in one step of {dt:.3g} s")

    def _fail(self, body: Body, point: int, reason: str) -> None:
        x, y = body.points[X, point], body.points[Y, point]
        raise SimulationError(
            f"t = {self.time:.6g} s, step {self.steps}: point {body.ids[point]} of {body.name} ({body.law.name}) "
            f"at ({x:.6g}, {y:.6g}) m: {reason}"
        )


def _walls(scene: Scene) -> list[Wall]:
    sections = [(side, getattr(scene.boundary, side)) for side in SIDES]
    return [
        Wall(side, WallKind[section.kind.upper()], section.coefficient, section.velocity)
        for side, section in sections
        if section.kind != "periodic"
    ]


def _periodic_axes(scene: Scene) -> list[int]:
    kinds = (scene.boundary.left.kind, scene.boundary.bottom.kind)
    return [axis for axis, kind in enumerate(kinds) if kind == "periodic"]
