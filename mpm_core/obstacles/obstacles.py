"""All obstacles of a run: which are there, how they move, and what acts on them."""

from collections.abc import Callable, Sequence
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.active_nodes import DRIFT
from grainlaw.mpm_core.grid.cell_volumes import CellWindow, Room
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.obstacles.contact import ObstacleContact, TakenByObstacles, distances
from grainlaw.mpm_core.obstacles.free_room import FreeRoom
from grainlaw.mpm_core.obstacles.obstacle import Obstacle


class Obstacles:
    """The obstacles of a run, in the order of the scene; only those that are there yet take part.

    `wall_time` is what steps have spent on them so far [s].
    """

    def __init__(self, obstacles: Sequence[Obstacle], free_room: FreeRoom) -> None:
        self.all = list(obstacles)
        self.present = list(obstacles)
        self._free_room = free_room
        self._contact: ObstacleContact | None = None
        self.wall_time = 0.0

    @property
    def candidates(self) -> int:
        """Pairs of points and obstacles that may touch before the next sort."""
        return sum(map(len, self._contact.pairs)) if self._contact is not None else 0

    @property
    def largest_speed(self) -> float:
        """The speed of the fastest point of any surface [m/s]."""
        return max((obstacle.largest_speed for obstacle in self.present), default=0.0)

    def room_of(self, window: CellWindow) -> Room | None:
        """What obstacles leave of the cells of a window; None without any."""
        return self._free_room.of_window(self.present, window)

    @property
    def states(self) -> dict[str, NDArray[np.float64]]:
        """The states of all obstacles by name, for a checkpoint; those that were taken away have none."""
        return {obstacle.name: obstacle.state for obstacle in self.present}

    @states.setter
    def states(self, states: dict[str, NDArray[np.float64]]) -> None:
        self.present = [obstacle for obstacle in self.all if obstacle.name in states]
        for obstacle in self.present:
            obstacle.state = states[obstacle.name]

    def find_contacts(self, bodies: Sequence[Body], grid: Grid, basis: Basis) -> None:
        """Find the points that may touch before the next sort."""
        self._contact = ObstacleContact(self.present, bodies, grid, basis, DRIFT) if self.present else None

    def is_stirring(self, positions: NDArray[np.float64], reach: float) -> NDArray[np.bool_]:
        """Which of the places, shape (axes, n) [m], lie within a reach [m] of an obstacle that moves."""
        near = np.zeros(positions.shape[1], np.bool_)
        for obstacle in self.present:
            if obstacle.largest_speed > 0.0:
                near |= distances(obstacle, positions) < reach
        return near

    def take_away(self, time: float) -> bool:
        """Leave out those that are not there any more at a time [s]; returns whether there were any."""
        left = [obstacle for obstacle in self.present if obstacle.is_there(time)]
        is_less, self.present = len(left) < len(self.present), left
        return is_less

    def apply(self, time: float, dt: float, hold_at_walls: Callable[[], None]) -> TakenByObstacles | None:
        """Apply contact to the new velocities of the nodes, and move on, in a step of dt [s] that begins at a time [s].

        Walls hold what contact pushes against them. Returns None where nothing can touch.
        """
        started = perf_counter()
        for obstacle in self.present:
            obstacle.motion.before(time, dt)
        taken = self._contact.apply(dt) if self._contact is not None else None
        if taken is not None and taken.impulses.any():
            hold_at_walls()
        for number, obstacle in enumerate(self.present):
            impulse = taken.impulses[number] if taken is not None else None
            obstacle.advance(dt, impulse)
        self.wall_time += perf_counter() - started
        return taken
