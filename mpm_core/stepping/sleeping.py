"""Material at rest sleeps: it costs nothing until something moves it.

Falling asleep. A point sleeps when, over a window of time, no point in `RING` nodes around it was displaced by more
than `speed` times the window: slower creep is what a scene that asks for sleep calls rest. What sleeping points bring
to the grid, mass, volume and the force of their stress, is kept on a grid of its own, from which each step starts in
place of zeros. They bring no momentum, and their state does not change.

Asleep. What sleeps is rigid: nodes with sleeping mass are held, after the walls have done their part. The momentum that
is withheld from a node in each step is summed up over the window.

Waking. What lies in `RING` cells around an obstacle that moves wakes, and does not fall asleep. Where that sum exceeds
the momentum of a full cell at `WAKING` times `speed`, the points in `RING` nodes around wake; every `STEPS_PER_LOOK`
steps somebody looks, in which time no wave gets out of the ring (with steps of the usual safety).

Error. A point that would have gone on creeping as it did stays behind by `speed` times the time that it slept, and the
force that holds a node is, in the mean of a window, less than that which gives a full cell an acceleration of
WAKING speed/window. Waves of stress stop where they fall asleep; the kinetic energy that is given up counts as
numerical dissipation.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.active_nodes import ActiveNodes, find_active_nodes, no_active_nodes
from grainlaw.mpm_core.grid.grid import BULK_COMPONENTS, COMPONENTS, Grid
from grainlaw.mpm_core.grid.periodic import join_marks
from grainlaw.mpm_core.kernels.grid_update import clear_bulk, clear_nodes, sum_of_columns
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.simd.registers import MOST_AT_ONCE
from grainlaw.mpm_core.kernels.sleepers import (
    RING,
    copy_nodes,
    first_node_is_marked,
    hold_sleepers,
    mark_first_nodes,
    nodes_to_wake,
    spread,
)
from grainlaw.mpm_core.obstacles.obstacles import Obstacles
from grainlaw.mpm_core.scene.model import SleepSection

# The momentum withheld from a node that wakes it, over that of a full cell at the speed below which points fall asleep.
WAKING = 40.0
# Steps between two looks at what is withheld.
STEPS_PER_LOOK = 8


class Sleep:
    """Which points sleep, and what they bring to the grid; `started` [s] is when the present window began.

    positions    positions of each body's points at that time, in the order of generation, shape (axes, n) [m]
    withheld     momentum withheld from each node since then, shape (nodes, axes) [kg m/s]
    nodes, bulk  what the sleeping points bring, as in `Grid.nodes` and `Grid.bulk`
    held         whether sleeping points bring mass to a node, or to another copy of it across a periodic axis
    full         mass of a full cell of the densest body at the start [kg]; in axisymmetry at a radius of one cell
    """

    def __init__(
        self,
        settings: SleepSection,
        bodies: Sequence[Body],
        grid: Grid,
        basis: Basis,
        periodic_axes: Sequence[int],
        obstacles: Obstacles,
    ) -> None:
        self.speed = settings.speed or 0.0
        self.window = settings.window
        self.bodies = bodies
        self.grid = grid
        self.basis = basis
        self.periodic_axes = periodic_axes
        self.obstacles = obstacles
        # Before the first window: one that ends when that is to begin, in which every point came from far away.
        self.started = settings.start - settings.window
        self.positions = [np.full((grid.space.axes, body.count), np.inf) for body in bodies]
        self.withheld = self._nothing_withheld()
        self.nodes, self.bulk = grid.empty_nodes(), grid.empty_bulk()
        self.held = np.zeros(grid.shape, np.bool_)
        self.active = no_active_nodes(grid)
        self.full = max(body.initial_density for body in bodies) * grid.cell_size ** (
            3 if grid.space.hoop else grid.space.axes
        )

    @property
    def has_sleepers(self) -> bool:
        """Whether any point sleeps."""
        return any(body.awake < body.count for body in self.bodies)

    def take_in_new_points(self) -> None:
        """Know of points that came since: from far away, so that they do not sleep before they have rested."""
        for number, body in enumerate(self.bodies):
            more = body.generated - self.positions[number].shape[1]
            if more > 0:
                self.positions[number] = np.pad(self.positions[number], ((0, 0), (0, more)), constant_values=np.inf)
        self.bring_sleepers()

    def open_window(self, time: float) -> None:
        """Begin a window at a time [s]."""
        self.started = time
        # New memory rather than zeros in the old: occupied only where something is withheld.
        self.withheld = self._nothing_withheld()
        for body, positions in zip(self.bodies, self.positions, strict=True):
            positions[:, body.numbers] = body.positions

    def lay_on_grid(self, active: ActiveNodes, couples_volumes: bool) -> None:
        """Let the active nodes start from what the sleeping points bring; to couple volumes also those."""
        column = self.grid.shape[-1]
        copy_nodes(self.nodes, self.grid.nodes, COMPONENTS, column, active.columns)
        if couples_volumes and len(self.bulk) > 0:
            copy_nodes(self.bulk, self.grid.bulk, BULK_COMPONENTS, column, active.columns)

    def hold(self, active: ActiveNodes) -> float:
        """Hold the nodes with sleeping mass, if there are any.

        Returns by how much the work of the forces on the nodes changes thereby [J and the space's amount].
        """
        if not self.has_sleepers:
            return 0.0
        held, grid = self.held.reshape(-1), self.grid
        on_nodes = grid.nodes, grid.components, held, self.withheld, grid.shape[-1]
        return sum_of_columns(hold_sleepers(*on_nodes, active.columns, grid.counted))

    def wake_up(self, active: ActiveNodes) -> bool:
        """Wake what is near an active node from which too much is withheld; returns whether anything woke."""
        waking = self.full * WAKING * self.speed
        to_wake = nodes_to_wake(self.withheld, waking * waking, self.grid.shape[-1], active.columns)
        stirred = np.pad(to_wake.reshape(self.grid.shape), RING)
        for body in self.bodies:
            asleep = body.positions[:, body.awake :]
            mark_first_nodes(asleep[:, self._is_stirred(asleep)], *self._on_marks(stirred))
        if not stirred.any():
            return False
        stirred = spread(stirred, RING, RING)
        self._join(stirred)
        on_grid = stirred[(slice(RING, -RING),) * stirred.ndim]
        self.withheld[on_grid.reshape(-1)] = 0.0
        woke = False
        for body in self.bodies:
            wakes = self._touched(body.points_asleep, stirred)
            if wakes.any():
                body.divide(np.concatenate([np.zeros(body.awake, np.bool_), ~wakes]))
                woke = True
        return woke

    def fall_asleep(self, time: float) -> bool:
        """At the end of a window, send to sleep what rested; returns whether anything fell asleep."""
        if time - self.started < self.window:
            return False
        stirred = np.zeros([nodes + 2 * RING for nodes in self.grid.shape], np.bool_)
        for body, positions in zip(self.bodies, self.positions, strict=True):
            ways = body.positions - positions[:, body.numbers]
            displaced = np.sqrt((ways**2).sum(axis=0)) > self.speed * (time - self.started)
            moving = displaced | self._is_stirred(body.positions)
            mark_first_nodes(body.positions[:, moving], *self._on_marks(stirred))
        stirred = spread(stirred, RING, RING + self.basis.width - 1)
        self._join(stirred)
        fell = False
        for body in self.bodies:
            slept = np.ones(body.count - body.awake, np.bool_)
            sleeps = np.concatenate([~self._touched(body.points_awake, stirred), slept])
            if np.count_nonzero(sleeps) >= body.count - body.awake + MOST_AT_ONCE:
                body.divide(sleeps)
                fell = True
        self.open_window(time)
        return fell

    def _is_stirred(self, positions: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which places lie around an obstacle that moves."""
        return self.obstacles.is_stirring(positions, RING * self.grid.cell_size)

    def bring_sleepers(self) -> None:
        """Scatter anew what the sleeping points bring, after some woke or fell asleep."""
        clear_nodes(self.nodes, self.grid, self.active)
        clear_bulk(self.bulk, self.grid, self.active)
        self.active = find_active_nodes([body.points_asleep for body in self.bodies], self.grid, self.basis, ())
        for body in self.bodies:
            body.p2g_of_sleepers(self.nodes, self.bulk, self.grid)
        self.held = self.nodes[self.grid.components.mass :: COMPONENTS].reshape(self.grid.shape) > 0.0
        self._join(self.held)

    def _join(self, marks: NDArray[np.bool_]) -> None:
        for axis in self.periodic_axes:
            join_marks(marks, axis, self.grid.cells[axis])

    def _touched(self, points: NDArray[np.float64], stirred: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether any node of each point is marked."""
        before = spread(stirred, self.basis.width - 1, 0)
        touched: NDArray[np.bool_] = first_node_is_marked(points[: self.grid.space.axes], *self._on_marks(before))
        return touched

    def _on_marks(self, marks: NDArray[np.bool_]) -> tuple[Any, ...]:
        """What tells of a point where it is among marks that reach `RING` nodes beyond each side, and the marks.

        Nodes beyond a side may be the inside, across a periodic axis.
        """
        return self.grid.origin, self.grid.cell_size, self.basis.offset, marks.shape, marks.reshape(-1)

    def _nothing_withheld(self) -> NDArray[np.float64]:
        return np.zeros((math.prod(self.grid.shape), self.grid.space.axes))
