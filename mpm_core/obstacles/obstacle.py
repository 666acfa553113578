"""Obstacles: rigid bodies with a surface, a friction coefficient, and a motion that is given or follows from forces."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.obstacles.motion import Motion, Pose
from grainlaw.mpm_core.obstacles.surface import Surface

Floats = NDArray[np.float64]

# An obstacle to compiled code: its surface, of which the numbers lie between `start` and `end` of one array for all;
# what stands for -1 if it is hollow; its friction; the position of its frame, the rotation from its frame, row after
# row; its velocity and, about the position, its angular velocity.
OBSTACLE = np.dtype(
    [
        ("kind", np.int64),
        ("start", np.int64),
        ("end", np.int64),
        ("sign", np.float64),
        ("friction", np.float64),
        ("position", np.float64, 3),
        ("rotation", np.float64, 9),
        ("velocity", np.float64, 3),
        ("spin", np.float64, 3),
    ]
)


@dataclass
class Forces:
    """What acted on an obstacle since the last row of the history: impulse [N s] and its moment [N m s]."""

    impulse: Floats
    moment: Floats
    duration: float = 0.0

    def reset(self) -> None:
        """Forget what acted so far."""
        self.impulse, self.moment, self.duration = np.zeros(3), np.zeros(3), 0.0

    def means(self) -> tuple[Floats, Floats]:
        """Mean force [N] and torque [N m] about the obstacle's position, both of three components."""
        over = self.duration if self.duration > 0.0 else 1.0
        return self.impulse / over, self.moment / over


@dataclass
class Obstacle:
    """A rigid obstacle. `hollow` ones hold material inside; after `until` [s] it is not there any more.

    `motion` says where it is and how it moves; forces are per width, per radian or whole as the space has it.
    """

    name: str
    surface: Surface
    friction: float
    motion: Motion
    hollow: bool = False
    until: float = np.inf
    forces: Forces = field(default_factory=lambda: Forces(np.zeros(3), np.zeros(3)))

    def is_there(self, time: float) -> bool:
        """Whether the obstacle is there at a time [s]."""
        return time < self.until

    @property
    def state(self) -> Floats:
        """All that changes, for a checkpoint, shape (28,)."""
        forces = self.forces
        return np.concatenate([self.motion.state, forces.impulse, forces.moment, [forces.duration]])

    @state.setter
    def state(self, values: Floats) -> None:
        self.motion.state, impulse, moment, duration = np.split(values, [21, 24, 27])
        self.forces = Forces(impulse, moment, float(duration[0]))

    def advance(self, dt: float, impulses: Floats | None) -> None:
        """Move on after a step of dt [s] in which impulse and moment, shape (6,), acted."""
        acted = np.zeros(6) if impulses is None else impulses
        self.forces.impulse += acted[:3]
        self.forces.moment += acted[3:]
        self.forces.duration += dt
        self.motion.after(dt, acted[:3], acted[3:])

    @property
    def largest_speed(self) -> float:
        """The speed of the fastest point of its surface [m/s]."""
        pose = self.motion.pose
        turning = float(np.linalg.norm(pose.spin))
        return float(np.linalg.norm(pose.velocity)) + (turning * self.surface.radius if turning > 0.0 else 0.0)


def as_rows(obstacles: Sequence[Obstacle]) -> tuple[NDArray[np.void], Floats]:
    """Obstacles as `OBSTACLE`, and the numbers of all their surfaces."""
    rows, start = np.zeros(len(obstacles), OBSTACLE), 0
    for row, obstacle in zip(rows, obstacles, strict=True):
        surface = obstacle.surface
        row["kind"], row["start"], row["end"] = surface.kind, start, start + len(surface.numbers)
        row["friction"], row["sign"] = obstacle.friction, -1.0 if obstacle.hollow else 1.0
        put_pose(row, obstacle.motion.pose)
        start += len(surface.numbers)
    return rows, np.concatenate([np.empty(0), *(obstacle.surface.numbers for obstacle in obstacles)])


def put_pose(row: np.void, pose: Pose) -> None:
    """Store where an obstacle is and how it moves in its row."""
    row["position"], row["rotation"] = pose.position, pose.rotation.ravel()
    row["velocity"], row["spin"] = pose.velocity, pose.spin
