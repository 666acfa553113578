"""Material at rest sleeps: it costs nothing until something moves it.

Falling asleep. A point sleeps when, over a window of time, no point in `RING` nodes around it was displaced by more
than `speed` times the window: slower creep is what a scene that asks for sleep calls rest. What sleeping points bring
to the grid, mass, volume and the force of their stress, is kept on a grid of its own, from which each step starts in
place of zeros. They bring no momentum, and their state does not change.

Asleep. What sleeps is rigid: nodes with sleeping mass are held, after the walls have done their part. The momentum that
is withheld from a node in each step is summed up over the window.

Waking. Where that sum exceeds the momentum of a full cell at `WAKING` times `speed`, the points in `RING` nodes around
wake; every `STEPS_PER_LOOK` steps somebody looks, in which time no wave gets out of the ring (with steps of the usual
safety).

Error. A point that would have gone on creeping as it did stays behind by `speed` times the time that it slept, and the
force that holds a node is, in the mean of a window, less than that which gives a full cell an acceleration of
WAKING speed/window. Waves of stress stop where they fall asleep; the kinetic energy that is given up counts as
numerical dissipation.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.active_nodes import ActiveNodes, find_active_nodes, no_active_nodes
from grainlaw.mpm_core.grid.grid import COMPONENTS, MASS, Grid
from grainlaw.mpm_core.grid.periodic import join_marks
from grainlaw.mpm_core.kernels.grid_update import clear_nodes
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.kernels.simd.registers import MOST_AT_ONCE
from grainlaw.mpm_core.kernels.sleepers import (
    RING,
    copy_nodes,
    hold_sleepers,
    stir_around_points,
    stir_nodes,
    touches_stirred,
)
from grainlaw.mpm_core.layout import X, Y
from grainlaw.mpm_core.scene.model import SleepSection

# The momentum withheld from a node that wakes it, over that of a full cell at the speed below which points fall asleep.
WAKING = 40.0
# Steps between two looks at what is withheld.
STEPS_PER_LOOK = 8


class Sleep:
    """Which points sleep, and what they bring to the grid; `started` [s] is when the present window began.

    positions    positions of each body's points at that time, in the order of generation, shape (2, n) [m]
    withheld  momentum withheld from each node since then, shape (nodes along x, along y, 2) [kg/s]
    nodes     what the sleeping points bring, as in `Grid.nodes`
    held      whether sleeping points bring mass to a node, or to another copy of it across a periodic axis
    full      mass of a full cell of the densest body at the start [kg/m]
    """

    def __init__(
        self, settings: SleepSection, bodies: Sequence[Body], grid: Grid, basis: Basis, periodic_axes: Sequence[int]
    ) -> None:
        self.speed = settings.speed or 0.0
        self.window = settings.window
        self.bodies = bodies
        self.grid = grid
        self.basis = basis
        self.periodic_axes = periodic_axes
        # Before the first window: one that ends when that is to begin, in which every point came from far away.
        self.started = settings.start - settings.window
        self.positions = [np.full((2, body.count), np.inf) for body in bodies]
        self.withheld = np.zeros((*grid.shape, 2))
        self.nodes = grid.empty_nodes()
        self.held = np.zeros(grid.shape, np.bool_)
        self.active = no_active_nodes(grid)
        self.full = max(body.initial_density for body in bodies) * grid.cell_size**2

    @property
    def has_sleepers(self) -> bool:
        """Whether any point sleeps."""
        return any(body.awake < body.count for body in self.bodies)

    def open_window(self, time: float) -> None:
        """Begin a window at a time [s]."""
        self.started = time
        # New memory rather than zeros in the old: occupied only where something is withheld.
        self.withheld = np.zeros((*self.grid.shape, 2))
        for body, positions in zip(self.bodies, self.positions, strict=True):
            positions[:, body.ids - body.first_id] = body.positions

    def lay_on_grid(self, active: ActiveNodes) -> None:
        """Let the active nodes start from what the sleeping points bring."""
        copy_nodes(self.nodes, self.grid.nodes, self.grid.shape[1], active)

    def hold(self, active: ActiveNodes) -> None:
        """Hold the nodes with sleeping mass, if there are any."""
        if self.has_sleepers:
            hold_sleepers(self.grid.nodes, self.held, self.withheld, active)

    def wake_up(self, active: ActiveNodes) -> bool:
        """Wake what is near an active node from which too much is withheld; returns whether anything woke."""
        stirred = self._no_marks()
        waking = self.full * WAKING * self.speed
        if not stir_nodes(self.withheld, waking * waking, active, stirred):
            return False
        self._join(stirred)
        self.withheld[stirred[RING:-RING, RING:-RING]] = 0.0
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
        stirred = self._no_marks()
        for body, positions in zip(self.bodies, self.positions, strict=True):
            was = positions[:, body.ids - body.first_id]
            displaced = np.hypot(*(body.positions - was)) > self.speed * (time - self.started)
            stir_around_points(*body.positions[:, displaced], *self._stencil(), stirred)
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

    def bring_sleepers(self) -> None:
        """Scatter anew what the sleeping points bring, after some woke or fell asleep."""
        clear_nodes(self.nodes, self.grid, self.active)
        self.active = find_active_nodes([body.points_asleep for body in self.bodies], self.grid, self.basis, ())
        for body in self.bodies:
            body.p2g_of_sleepers(self.nodes, self.grid)
        self.held = self.nodes[MASS::COMPONENTS].reshape(self.grid.shape) > 0.0
        self._join(self.held)

    def _no_marks(self) -> NDArray[np.bool_]:
        """No node marked, nor any in `RING` rows beyond each side, which may be the inside across a periodic axis."""
        return np.zeros([nodes + 2 * RING for nodes in self.grid.shape], np.bool_)

    def _join(self, marks: NDArray[np.bool_]) -> None:
        for axis in self.periodic_axes:
            join_marks(marks, axis, self.grid.cells[axis])

    def _touched(self, points: NDArray[np.float64], stirred: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Whether any node of each point is marked."""
        touched: NDArray[np.bool_] = touches_stirred(points[X], points[Y], *self._stencil(), stirred)
        return touched

    def _stencil(self) -> tuple[tuple[float, float], float, float, int]:
        return self.grid.origin, self.grid.cell_size, self.basis.offset, self.basis.width
