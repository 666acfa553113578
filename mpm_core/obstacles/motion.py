"""The motion of an obstacle: fixed, at a given velocity, along a table of poses, or free under gravity and contact."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def turn_about(vector: Floats) -> "scipy.spatial.transform.Rotation":
    """The rotation about a vector [rad] by its length; of several, shape (n, 3), one each."""
    return scipy.spatial.transform.Rotation.from_rotvec(vector)


@dataclass
class Pose:
    """Where an obstacle is and how it moves, all in three components, in two axes with z out of the plane.

    position  of its frame [m]
    rotation  matrix from its frame to space, shape (3, 3)
    velocity  of its frame [m/s]
    spin      angular velocity [1/s]
    """

    position: Floats
    rotation: Floats
    velocity: Floats
    spin: Floats

    def advance(self, dt: float) -> None:
        """Move on for a time [s] at the present velocities."""
        self.position = self.position + dt * self.velocity
        if self.spin.any():
            self.rotation = turn_about(dt * self.spin).as_matrix() @ self.rotation


def in_3d(vector: Sequence[float] | Floats | None) -> Floats:
    """A vector of two or three components as one of three; zero for none."""
    whole = np.zeros(3)
    if vector is not None:
        whole[: len(vector)] = vector
    return whole


def at_rest(position: Sequence[float] | Floats, rotation: Floats | None = None) -> Pose:
    """A pose without motion; `position` may have two components."""
    return Pose(in_3d(position), np.eye(3) if rotation is None else rotation, np.zeros(3), np.zeros(3))


class Motion(ABC):
    """What moves an obstacle; `pose` is the present one."""

    def __init__(self, pose: Pose, center: Floats | None = None) -> None:
        """`center` is about what it turns [m], by default the frame's position."""
        self.pose = pose
        self.center = pose.position if center is None else center

    @property
    def moves(self) -> bool:
        """Whether it is ever anywhere else."""
        return True

    @property
    def is_fixed(self) -> bool:
        """Whether it never moves."""
        return False

    @property
    def state(self) -> Floats:
        """All that changes, for a checkpoint, shape (21,)."""
        pose = self.pose
        return np.concatenate([pose.position, pose.rotation.ravel(), pose.velocity, pose.spin, self.center])

    @state.setter
    def state(self, values: Floats) -> None:
        position, rotation, velocity, spin, center = np.split(values, [3, 12, 15, 18])
        self.pose = Pose(position, rotation.reshape(3, 3), velocity, spin)
        self.center = center

    @abstractmethod
    def before(self, time: float, dt: float) -> None:
        """Set the velocities for a step of dt [s] that begins at a time [s]."""

    def after(self, dt: float, impulse: Floats, moment: Floats) -> None:
        """Move on after a step in which contacts gave an impulse [N s] and a moment of it [N m s]."""
        self.pose.advance(dt)


class Steady(Motion):
    """At rest, or at a constant velocity and a constant spin about a centre that moves with it."""

    def __init__(self, pose: Pose, velocity: Floats, spin: Floats, center: Floats) -> None:
        super().__init__(pose, center)
        self.frame_velocity = velocity
        self.pose.spin = spin

    @property
    def moves(self) -> bool:
        """Whether it has a velocity or a spin."""
        return bool(self.frame_velocity.any() or self.pose.spin.any())

    @property
    def is_fixed(self) -> bool:
        """Whether it rests."""
        return not (self.frame_velocity.any() or self.pose.spin.any())

    def before(self, time: float, dt: float) -> None:
        """The frame moves with the centre, and around it, by half of the turn of the step."""
        if not self.pose.spin.any():
            self.pose.velocity = self.frame_velocity
            return
        half = turn_about(0.5 * dt * self.pose.spin).apply(self.pose.position - self.center)
        self.pose.velocity = self.frame_velocity + np.cross(self.pose.spin, half)

    def after(self, dt: float, impulse: Floats, moment: Floats) -> None:
        """Exactly around the centre, so that nothing drifts outwards over many turns."""
        if not self.pose.spin.any():
            self.pose.position = self.pose.position + dt * self.frame_velocity
            self.center = self.center + dt * self.frame_velocity
            return
        turn = turn_about(dt * self.pose.spin)
        arm = turn.apply(self.pose.position - self.center)
        self.center = self.center + dt * self.frame_velocity
        self.pose.position = self.center + arm
        self.pose.rotation = turn.as_matrix() @ self.pose.rotation


class Along(Motion):
    """Through a table of poses: positions linear in time between them, rotations at a constant spin."""

    def __init__(self, times: Floats, positions: Floats, rotations: "scipy.spatial.transform.Rotation") -> None:
        self.times, self.positions, self.rotations = times, positions, rotations
        self.turns = scipy.spatial.transform.Slerp(times, rotations)
        self.time = float(times[0])
        super().__init__(at_rest(positions[0], rotations[0].as_matrix()))

    def _at(self, time: float) -> tuple[Floats, "scipy.spatial.transform.Rotation"]:
        inside = min(max(time, float(self.times[0])), float(self.times[-1]))
        position = np.array([np.interp(inside, self.times, along) for along in self.positions.T])
        return position, self.turns(inside)

    def before(self, time: float, dt: float) -> None:
        """The velocities that lead to the pose at the end of the step; before and after the table it rests."""
        (here, turned), (there, further) = self._at(time), self._at(time + dt)
        self.time = time + dt
        self.pose.position, self.pose.rotation = here, turned.as_matrix()
        self.pose.velocity = (there - here) / dt
        self.pose.spin = (further * turned.inv()).as_rotvec() / dt

    def after(self, dt: float, impulse: Floats, moment: Floats) -> None:
        """To the pose of the table."""
        position, rotation = self._at(self.time)
        self.pose.position, self.pose.rotation = position, rotation.as_matrix()


class Free(Motion):
    """Under gravity and what contacts do, with a mass [kg] and an inertia about its frame, shape (3,) [kg m2].

    `is_free` says which components of velocity and spin there are, shape (6,); the frame is the centre of mass.
    """

    def __init__(self, pose: Pose, mass: float, inertia: Floats, gravity: Floats, is_free: NDArray[np.bool_]) -> None:
        super().__init__(pose)
        self.mass = mass
        self.inertia = inertia
        self.gravity = gravity
        self.is_free = is_free

    def before(self, time: float, dt: float) -> None:
        """Half of the weight's impulse comes before the contact, half after."""
        self.pose.velocity = self.pose.velocity + 0.5 * dt * np.where(self.is_free[:3], self.gravity, 0.0)

    def after(self, dt: float, impulse: Floats, moment: Floats) -> None:
        """Take the impulses of gravity and contact, then move on (Euler's equations in the frame of the body)."""
        pose = self.pose
        pushed = impulse / self.mass + 0.5 * dt * self.gravity
        pose.velocity = pose.velocity + np.where(self.is_free[:3], pushed, 0.0)
        in_frame = pose.rotation.T @ pose.spin
        twist = pose.rotation.T @ moment - dt * np.cross(in_frame, self.inertia * in_frame)
        pose.spin = pose.spin + np.where(self.is_free[3:], pose.rotation @ (twist / self.inertia), 0.0)
        pose.advance(dt)
