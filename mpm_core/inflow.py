"""Mouths through which material enters, point by point.

The mouth is a lattice of parts, and what enters a row of layers one `thickness` thick. The middle of layer k passes the
mouth at the time (k + 1/2) thickness/speed after the start, with the velocity of the inflow; there its point is put in,
further by what it has come since. The rate is density times area times speed, to half a layer.

A part waits while a point lies in the way, nearer than `ROOM` of the spacing: what is there gets no second point in its
place. What did not enter in that time is not made up for.
"""

import math
import warnings
from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from grainlaw.materials.errors import InputWarning
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.carried import Carried, all_carried, carried_by
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.kernels.positions import put_positions
from grainlaw.mpm_core.kernels.shape_functions import Basis
from grainlaw.mpm_core.scene.inflow import Layer

Floats = NDArray[np.float64]

# Of the spacing: a flow that slows down a little beyond the mouth does not stop what enters.
ROOM = 0.75
# Of a layer: times are sums of steps.
ROUND_OFF = 1e-9


class Inflow:
    """A mouth and the body of what came through it.

    layer, velocity  of the mouth, and with which material enters, shape (axes,) [m/s]
    thickness        of a layer [m]
    template         the rows of a point that enters; `masses` those of the points of a layer, in axisymmetry
    start, until     when it begins and ends [s]
    signal_speed     what bounds the step while material enters [m/s]
    entered          how many layers each part of the mouth has let in
    waited           for how long each part has waited [s]
    was_blocked      whether any part ever has
    """

    def __init__(
        self,
        name: str,
        body: Body,
        layer: Layer,
        velocity: Floats,
        thickness: float,
        template: NDArray[np.floating],
        masses: Floats | None,
        start: float,
        until: float,
        signal_speed: float,
    ) -> None:
        self.name = name
        self.body = body
        self.layer = layer
        self.velocity = velocity
        self.thickness = thickness
        self.template = template
        self.masses = masses
        self.start = start
        self.until = until
        self.signal_speed = signal_speed
        self.interval = thickness / float(velocity @ layer.normal)
        self.entered = np.zeros(len(layer.areas), np.int64)
        self.waited = np.zeros(len(layer.areas))
        self.was_blocked = False

    def points_until(self, time: float) -> int:
        """How many points enter until a time [s], where nothing blocks them."""
        lasting = max(0.0, min(time, self.until) - self.start)
        return math.floor(lasting / self.interval + 0.5 + ROUND_OFF) * len(self.entered)

    def let_in(self, time: float, bodies: Sequence[Body]) -> int:
        """Let in what is due at a time [s], where `bodies` leave room; returns how many points there were."""
        waiting, came = np.zeros(len(self.entered), np.bool_), 0
        while True:
            due = np.flatnonzero(self._is_due(time) & ~waiting)
            if len(due) == 0:
                return came
            lasting = time - self.start - self.waited[due] - (self.entered[due] + 0.5) * self.interval
            places = self.layer.centers[due] + lasting[:, np.newaxis] * self.velocity
            blocked = self._is_blocked(places, bodies)
            waiting[due[blocked]] = True
            self._wait(due[blocked], time)
            self._put(due[~blocked], places[~blocked])
            came += int(np.count_nonzero(~blocked))

    def _is_due(self, time: float) -> NDArray[np.bool_]:
        lasting = min(time, self.until) - self.start - self.waited
        return np.asarray(np.floor(lasting / self.interval + 0.5 + ROUND_OFF) > self.entered)

    def _is_blocked(self, places: Floats, bodies: Sequence[Body]) -> NDArray[np.bool_]:
        """Which of the places have a point nearer than `ROOM` of the spacing along each direction of the mouth."""
        frame = np.vstack([self.layer.across, self.layer.normal])
        scale = np.append(self.layer.spacing, self.thickness)[:, np.newaxis]
        sought = frame @ places.T / scale
        lowest, highest = sought.min(axis=1, keepdims=True) - ROOM, sought.max(axis=1, keepdims=True) + ROOM
        near = [np.empty((0, len(frame)))]
        for body in bodies:
            found = frame @ body.positions / scale
            near.append(found[:, ((found > lowest) & (found < highest)).all(axis=0)].T)
        distances, _ = scipy.spatial.cKDTree(np.concatenate(near)).query(sought.T, p=np.inf, distance_upper_bound=ROOM)
        return np.isfinite(distances)

    def _wait(self, parts: NDArray[np.int64], time: float) -> None:
        if len(parts) == 0:
            return
        self.waited[parts] = time - self.start - (self.entered[parts] + 0.5) * self.interval
        if not self.was_blocked:
            self.was_blocked = True
            warnings.warn(
                f"t = {time:.6g} s: inflow '{self.name}' is blocked by the material before it; it waits until there "
                "is room, and mass_in in history.csv tells what has entered",
                InputWarning,
                stacklevel=2,
            )

    def _put(self, parts: NDArray[np.int64], places: Floats) -> None:
        if len(parts) == 0:
            return
        points = np.repeat(self.template[:, np.newaxis], len(parts), axis=1)
        put_positions(points, places.T, self.body.space)
        if self.masses is not None:
            points[self.body.layout.mass] = self.masses[parts]
        self.body.add(points)
        self.entered[parts] += 1


class Inflows:
    """The inflows of a run, in the order of the scene."""

    def __init__(self, inflows: Sequence[Inflow]) -> None:
        self.all = list(inflows)

    @property
    def points_in(self) -> int:
        """How many points have entered."""
        return sum(inflow.body.generated for inflow in self.all)

    def signal_speed(self, time: float) -> float:
        """What bounds the step where material still enters at a time [s]."""
        return max((inflow.signal_speed for inflow in self.all if time < inflow.until), default=0.0)

    def points_until(self, time: float) -> int:
        """How many points enter until a time [s], where nothing blocks them."""
        return sum(inflow.points_until(time) for inflow in self.all)

    def let_in(
        self, time: float, bodies: Sequence[Body], grid: Grid, basis: Basis, gravity: Sequence[float], last_step: float
    ) -> Carried | None:
        """Let in what is due at a time [s], after a step [s]; returns what came, None if nothing did."""
        found = []
        for inflow in self.all:
            before = inflow.body.generated
            if inflow.let_in(time, bodies) > 0:
                new = inflow.body.numbers >= before
                found.append(carried_by(inflow.body, new, grid, basis, gravity, last_step))
        return all_carried(found)
