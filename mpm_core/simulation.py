"""The state of a run and one step of it. The step reads as the algorithm."""

import math
import time
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, SimulationError
from grainlaw.materials.errors import numbers_of
from grainlaw.mpm_core.failures import LARGEST_INCREMENT, failure_outside, failure_too_small, failure_unsound
from grainlaw.mpm_core.grid.active_nodes import ActiveNodes, find_active_nodes, no_active_nodes
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.grid.periodic import join_periodic
from grainlaw.mpm_core.grid.volume_projection import LONGEST_UNPROJECTED, project_volumes
from grainlaw.mpm_core.inflow import Inflows
from grainlaw.mpm_core.kernels.body_force import BodyForce, scatter_body_force
from grainlaw.mpm_core.kernels.elastic_energy import elastic_energy
from grainlaw.mpm_core.kernels.grid_update import clear_bulk, clear_nodes, update_nodes
from grainlaw.mpm_core.kernels.held_nodes import hold_nodes
from grainlaw.mpm_core.kernels.shape_functions import BASES
from grainlaw.mpm_core.kernels.step_report import StepReport, step_report, together
from grainlaw.mpm_core.kernels.volume_coupling import STEPS_PER_COUPLING
from grainlaw.mpm_core.kernels.wall_clearance import WallClearance
from grainlaw.mpm_core.kernels.walls import active_layers, hold_at_walls
from grainlaw.mpm_core.ledger import Ledger
from grainlaw.mpm_core.obstacles.free_room import FreeRoom
from grainlaw.mpm_core.obstacles.obstacles import Obstacles
from grainlaw.mpm_core.open_sides import let_leave
from grainlaw.mpm_core.output.fields import chosen_fields
from grainlaw.mpm_core.parallel.sorting import LONGEST_DRIFT
from grainlaw.mpm_core.parallel.threads import use_threads
from grainlaw.mpm_core.scene.build_inflows import build_inflows, check_mouths
from grainlaw.mpm_core.scene.build_obstacles import build_obstacles, check_start
from grainlaw.mpm_core.scene.build_walls import build_walls, open_sides, periodic_axes
from grainlaw.mpm_core.scene.initial_state import build_bodies
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.scene.resolution import refuse_coarse_stress
from grainlaw.mpm_core.stepping.sleeping import STEPS_PER_LOOK, Sleep
from grainlaw.mpm_core.stepping.time_step import (
    LARGEST_STRAIN,
    SMALLEST_SHARE,
    largest_diffusivity,
    signal_bounds,
    strain_rates,
)
from grainlaw.mpm_core.thin_plates import ThinPlates

# More than a run can ever take.
MOST_STEPS = 1e12


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
        self.periodic_axes = periodic_axes(scene)
        self.space = scene.in_space
        size = (scene.grid.lower, scene.grid.cells, scene.grid.cell_size)
        self.grid = Grid(self.space, *size, self.periodic_axes, scene.precision, open_sides(scene))
        self.fields = chosen_fields(scene)
        self.bodies = build_bodies(scene, keeps_shear_strain="shear_strain" in self.fields)
        self.initial_points = sum(body.count for body in self.bodies)
        refuse_coarse_stress(self.bodies, self._signals_of_points(), scene.gravity)
        self.inflows = Inflows(build_inflows(scene, self.initial_points, "shear_strain" in self.fields))
        bodies_at_start = list(self.bodies)
        self.bodies += [inflow.body for inflow in self.inflows.all]
        signals = self._signals_of_points()
        started = time.perf_counter()
        for body in self.bodies:
            body.choose_kernels(self.basis)
        initial_elastic = self.elastic_energy()
        self.build_time = time.perf_counter() - started
        self.walls = build_walls(scene)
        self.obstacles = Obstacles(build_obstacles(scene), FreeRoom(self.grid, self.periodic_axes))
        check_start(scene, self.obstacles.all, bodies_at_start)
        self.thin_plates = ThinPlates(self.obstacles.all, self.grid.cell_size)
        check_mouths(self.inflows.all, self.obstacles.all)
        self.body_force: BodyForce | None = None
        self.held_nodes = np.empty(0, np.int64)
        self.time = 0.0
        self.last_step = 0.0
        self.steps = 0
        self.drift = math.inf
        self.drift_unprojected = 0.0
        self.active = no_active_nodes(self.grid)
        self.wall_clearance = self._wall_clearance()
        kinetic = sum(0.5 * float((body.masses * body.speed**2).sum()) for body in self.bodies)
        self.ledger = Ledger(kinetic, kinetic, initial_elastic)
        self.projects_volumes = scene.transfer.volume_projection and any(body.is_loose for body in self.bodies)
        self.ways_bounded = 0
        self.sleep = self._sleep()
        # No signal is slower than a fall through one cell, for material without stiffness.
        self.free_fall_speed = math.sqrt(math.hypot(*scene.gravity) * self.grid.cell_size)
        self.signal_bounds = [signal_bounds(body) for body in self.bodies]
        self._take_signals(signals)
        first = self.scene.time.step or self.adaptive_step()
        if not first * MOST_STEPS > scene.time.end:
            raise InputError(
                f"time.end = {scene.time.end:g} s takes more than {MOST_STEPS:g} steps of {first:g} s, with signals of "
                f"{self.signal_speed:g} m/s through cells of {self.grid.cell_size:g} m"
            )
        self.smallest_step = self.scene.time.smallest_step or (SMALLEST_SHARE * first if first < math.inf else 0.0)

    def measure_signals(self) -> None:
        """Take what bounds the step from the points as they are, where a program has moved them."""
        self._take_signals(self._signals_of_points())

    def _signals_of_points(self) -> list[tuple[float, float]]:
        """Of each body the fastest signal and the fastest point [m/s], in plain Python."""
        signals = []
        for body in self.bodies:
            with numbers_of(body.law.name):
                signals.append((body.largest_signal_speed(), float(body.speed.max(initial=0.0))))
        return signals

    def _take_signals(self, signals: list[tuple[float, float]]) -> None:
        self.signal_speed = self._signal_speed(signals, [largest_diffusivity(body) for body in self.bodies])
        self.strain_rate = max(float(strain_rates(body).max(initial=0.0)) for body in self.bodies)

    def step(self, dt: float) -> None:
        """Advance by dt [s]. Raises SimulationError naming the point where the result cannot be right.

        Velocities belong to the middles of steps, and the forces at the end of one step act from its middle to that of
        the next, however long that is: with less, energy would come from steps that shrink as a body stiffens.
        """
        couples_volumes = self.steps % STEPS_PER_COUPLING == 0
        self._project_volumes_if_drifted()
        self._sort_if_drifted()
        self._clear_nodes(couples_volumes)
        self._p2g(couples_volumes)
        self._update_grid(dt, couples_volumes)
        self._g2p(dt, couples_volumes)
        self._update_stress(dt, couples_volumes)
        self.time += dt
        self.last_step = dt
        self.steps += 1
        self._take_reports(dt)
        if self.sleep is not None:
            self._let_sleep(self.sleep)
        self._let_in()

    def _p2g(self, couples_volumes: bool = False) -> None:
        for body in self.bodies:
            body.p2g(self.grid, self.threads, couples_volumes)
            if self.body_force is not None:
                scatter_body_force(body, self.body_force(body, self.time), self.grid, self.basis)
        for axis in self.periodic_axes:
            join_periodic(self.grid, self.grid.nodes, axis)
            if couples_volumes:
                join_periodic(self.grid, self.grid.bulk, axis)

    def _update_grid(self, dt: float, couples_volumes: bool) -> None:
        """Solve the momentum equation on the nodes, then walls, held nodes and sleepers have their say."""
        kick = 0.5 * (self.last_step + dt)
        self.ledger.work_on_nodes += update_nodes(self.grid, self.active, self.scene.gravity, kick, couples_volumes)
        clearances = self.wall_clearance.clearances()
        self._hold_at_walls(dt, clearances)
        if self.obstacles.present:
            self._touch_obstacles(dt, clearances)
        self.ledger.work_on_nodes += hold_nodes(self.grid, self.held_nodes)
        if self.sleep is not None:
            self.ledger.work_on_nodes += self.sleep.hold(self.active)

    def _hold_at_walls(self, dt: float, clearances: NDArray[np.float64]) -> None:
        taken = hold_at_walls(self.grid, self.wall_clearance.layers, clearances, dt)
        self.ledger.wall_work += taken.work
        self.ledger.wall_friction += taken.friction
        self.ledger.work_on_nodes += taken.of_forces

    def _touch_obstacles(self, dt: float, clearances: NDArray[np.float64]) -> None:
        taken = self.obstacles.apply(self.time, dt, lambda: self._hold_at_walls(dt, clearances))
        if taken is not None:
            self.ledger.obstacle_work += taken.work
            self.ledger.obstacle_friction += taken.friction
            self.ledger.work_on_nodes += taken.of_forces

    def _g2p(self, dt: float, couples_volumes: bool) -> None:
        for body in self.bodies:
            body.g2p(self.grid, dt, self._flip_fraction(dt), self.threads, couples_volumes)

    def _update_stress(self, dt: float, couples_volumes: bool) -> None:
        coupled_time = STEPS_PER_COUPLING * dt if couples_volumes else 0.0
        for body in self.bodies:
            body.update_stress(dt, coupled_time, self.threads)

    def advance_to(self, time: float) -> None:
        """Step to a time [s], with the steps of the scene.

        Raises InputError for a time that is past or not finite, and SimulationError as `step` and `next_step` do.
        """
        if not self.time <= time < math.inf:
            raise InputError(f"advance_to({time:g}): allowed are times from the present one, {self.time:g} s, on")
        for _ in self.steps_to(time):
            pass

    def steps_to(self, time: float) -> Iterator[float]:
        """The steps [s] to a time [s], each when it has been taken; whoever leaves the loop stops there."""
        use_threads(self.threads)
        while self.time < time:
            dt, arrival = self.next_step(time)
            self.step(dt)
            if arrival is not None:
                self.time = arrival
            yield dt

    def next_step(self, target: float) -> tuple[float, float | None]:
        """The next time step [s], and the time of arrival if it ends on the target.

        The step is the adaptive one, or the fixed one, shortened so that a whole number of equal steps leads there.
        Raises SimulationError below the smallest step, or if the fixed step has become unstable.
        """
        stable = self.critical_time_step()
        largest = self.scene.time.step or self.adaptive_step()
        if largest > stable:
            too_large = f"the fixed step {largest:.4g} s is above the stable one, now {stable:.4g} s"
            raise SimulationError(f"{self._when}: {too_large}")
        if largest < self.smallest_step:
            is_by_strain = largest < self.scene.time.safety * stable
            raise failure_too_small(self._when, self.bodies, largest, self.smallest_step, is_by_strain)
        remaining = target - self.time
        count = max(1, math.ceil(remaining / largest * (1.0 - 1e-12)))
        return remaining / count, target if count == 1 else None

    @property
    def _when(self) -> str:
        return f"t = {self.time:.6g} s, step {self.steps}"

    def critical_time_step(self) -> float:
        """The largest stable step [s] at the present state: a cell over the fastest signal; infinite without any."""
        return self.grid.cell_size / self.signal_speed if self.signal_speed > 0.0 else math.inf

    def adaptive_step(self) -> float:
        """The safe share of the stable step [s], or less, so that no point is strained too much in one step."""
        stable = self.scene.time.safety * self.critical_time_step()
        return min(stable, LARGEST_STRAIN / self.strain_rate) if self.strain_rate > 0.0 else stable

    def _signal_speed(self, reported: list[tuple[float, float]], diffusivities: list[float]) -> float:
        """The speed [m/s] that bounds the step.

        From the fastest signal and the fastest point of each body, and its largest viscosity over density [m2/s].
        """
        found = zip(self.signal_bounds, reported, diffusivities, strict=True)
        speeds = (bounds.speed(*pair, nu / self.grid.cell_size) for bounds, pair, nu in found)
        # A point in contact may be as fast as the obstacle in the next step.
        return max(self.free_fall_speed, self.inflows.signal_speed(self.time), *speeds) + self.obstacles.largest_speed

    def elastic_energy(self) -> float:
        """The present elastic energy of all bodies [J and the space's amount]; NaN if a law does not state it."""
        return sum(elastic_energy(body) for body in self.bodies)

    def _flip_fraction(self, dt: float) -> float:
        """The share of the unresolved velocity that outlives a step."""
        return math.exp(-dt / self.scene.blend_time) if self.scene.blend_time > 0.0 else 0.0

    def _clear_nodes(self, couples_volumes: bool) -> None:
        """Leave on the nodes only what sleeping points bring."""
        if self.sleep is not None and self.sleep.has_sleepers:
            self.sleep.lay_on_grid(self.active, couples_volumes)
        else:
            clear_nodes(self.grid.nodes, self.grid, self.active)
            if couples_volumes:
                clear_bulk(self.grid.bulk, self.grid, self.active)

    def _sort_if_drifted(self) -> None:
        if self.obstacles.take_away(self.time) or self.drift > LONGEST_DRIFT * self.grid.cell_size:
            self._sort()

    def _project_volumes_if_drifted(self) -> None:
        """Let points leave each cell the room it has, when the fastest has drifted far enough since that was done."""
        if self.projects_volumes and self.drift_unprojected > LONGEST_UNPROJECTED * self.grid.cell_size:
            self._wrap()
            if self._let_leave():
                self._sort()
            gaps, room_of = self.wall_clearance.gaps(), self.obstacles.room_of
            projected = project_volumes(self.bodies, self.grid, self.periodic_axes, self.scene.gravity, gaps, room_of)
            self.ledger.count_projection(projected.raised)
            self.ways_bounded += projected.bounded
            self.drift += projected.longest_way
            self.drift_unprojected = 0.0

    def _wrap(self) -> None:
        for axis in self.periodic_axes:
            for body in self.bodies:
                body.wrap(axis, self.grid.lower[axis], self.grid.upper[axis] - self.grid.lower[axis])

    def _sort(self) -> None:
        self._wrap()
        self._let_leave()
        for body in self.bodies:
            body.sort(self.grid, self.basis)
        self.drift = 0.0
        self.thin_plates.look(self.time, self.obstacles.present, self.bodies)
        self.find_active_nodes()

    def _let_in(self) -> None:
        """Let in what has come through mouths until now."""
        came = self.inflows.let_in(self.time, self.bodies, self.grid, self.basis, self.scene.gravity, self.last_step)
        if came is not None:
            self.ledger.count_inflow(came)
            self._sort()
            if self.sleep is not None:
                self.sleep.take_in_new_points()

    def _let_leave(self) -> bool:
        """Remove what has gone through open sides; returns whether anything has. What is left has to be sorted."""
        left = let_leave(self.bodies, self.grid, self.basis, self.scene.gravity, self.last_step)
        if left is not None:
            self.ledger.count_outflow(left)
            if self.sleep is not None:
                self.sleep.bring_sleepers()
        return left is not None

    def _sleep(self) -> Sleep | None:
        settings = self.scene.sleep
        if settings.speed is None:
            return None
        return Sleep(settings, self.bodies, self.grid, self.basis, self.periodic_axes, self.obstacles)

    def _let_sleep(self, sleep: Sleep) -> None:
        """Wake what something moves, and let fall asleep what rests."""
        looks = self.steps % STEPS_PER_LOOK == 0 and sleep.has_sleepers
        woke = looks and sleep.wake_up(self.active)
        # The reports of this step, of which the sleepers' signal speed is taken, serve one division.
        fell = not woke and self.body_force is None and sleep.fall_asleep(self.time)
        if woke or fell:
            self._sort()
            sleep.bring_sleepers()

    def find_active_nodes(self) -> None:
        """Find the nodes that points awake can touch until the next sort, and keep to them."""
        points = [body.points_awake for body in self.bodies]
        self.keep_to(find_active_nodes(points, self.grid, self.basis, self.periodic_axes))
        self.obstacles.find_contacts(self.bodies, self.grid, self.basis)

    def keep_to(self, active: ActiveNodes) -> None:
        """Work on these nodes until the next sort, and leave zeros everywhere else."""
        clear_nodes(self.grid.nodes, self.grid, self.active)
        clear_bulk(self.grid.bulk, self.grid, self.active)
        self.active = active
        self.wall_clearance = self._wall_clearance()

    def _wall_clearance(self) -> WallClearance:
        layers = active_layers(self.walls, self.grid, self.active, self.periodic_axes)
        return WallClearance(layers, self.bodies, self.grid, self.basis, self.periodic_axes, self.threads)

    def _take_reports(self, dt: float) -> None:
        reports = [step_report(body.transfer_reports, body.stress_reports) for body in self.bodies]
        for body, report in zip(self.bodies, reports, strict=True):
            is_finite = report.signal_speed < math.inf and report.diffusivity < math.inf
            if not (report.increment < LARGEST_INCREMENT and is_finite):
                raise failure_unsound(self._when, body, dt)
        whole = together(reports)
        self._refuse_lost_points(whole)
        self.drift += dt * (whole.fastest + self.obstacles.largest_speed)
        self.drift_unprojected += dt * whole.fastest
        self.strain_rate = whole.increment / dt
        signals = [
            (max(report.signal_speed, body.signal_speed_asleep), report.fastest)
            for body, report in zip(self.bodies, reports, strict=True)
        ]
        self.signal_speed = self._signal_speed(signals, [report.diffusivity for report in reports])
        self.ledger.count(
            kinetic=whole.kinetic,
            risen=-dt * sum(g * momentum for g, momentum in zip(self.scene.gravity, whole.momentum, strict=True)),
            worked=whole.internal_work,
        )

    def _refuse_lost_points(self, report: StepReport) -> None:
        extents = zip(report.lowest, report.highest, self.grid.limits, strict=True)
        for axis, (lowest, highest, (lower, upper)) in enumerate(extents):
            if lowest < lower or highest > upper:
                raise failure_outside(self._when, self.bodies, axis, lower, upper)
