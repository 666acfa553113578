"""Where a run cannot go on: errors that name the time, the point and what is wrong with it."""

from collections.abc import Sequence

import numpy as np

from grainlaw.materials import SimulationError
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.stepping.time_step import signal_speeds, strain_rates, what_sets_the_step

# A volumetric strain increment beyond which no explicit step can be right.
LARGEST_INCREMENT = 0.5


def failure_at(when: str, body: Body, point: int, reason: str) -> SimulationError:
    """The error that names a point of a body; `when` is the time and the step."""
    place = ", ".join(f"{coordinate:.6g}" for coordinate in body.positions[:, point])
    where = f"point {body.ids[point]} of {body.name} ({body.law.name}) at ({place}) m"
    return SimulationError(f"{when}: {where}: {reason}")


def failure_outside(when: str, bodies: Sequence[Body], axis: int, lower: float, upper: float) -> SimulationError:
    """The error of the first point that lies beyond the domain along an axis."""
    for body in bodies:
        outside = (body.positions[axis] < lower) | (body.positions[axis] > upper)
        if outside.any():
            return failure_at(when, body, int(np.argmax(outside)), "the point has left the domain")
    return SimulationError(f"{when}: a point has left the domain")


def failure_unsound(when: str, body: Body, dt: float) -> SimulationError:
    """The error of a body of which something is not finite, or a volume changed too much in a step."""
    finite = np.isfinite(body.points).all(axis=0)
    if not finite.all():
        return failure_at(when, body, int(np.argmin(finite)), "the stress or another quantity is not finite")
    increments = dt * strain_rates(body)
    worst = int(np.argmax(increments))
    if increments[worst] < LARGEST_INCREMENT:
        return failure_at(when, body, worst, "the law's sound speed or viscosity is not finite")
    return failure_at(when, body, worst, f"its volume changed by {increments[worst]:.0%} in one step of {dt:.3g} s")


def failure_too_small(
    when: str, bodies: Sequence[Body], step: float, smallest: float, is_by_strain: bool
) -> SimulationError:
    """The error of a run whose step [s] would fall below the smallest, naming the point that asks for it."""
    reason = strain_rates if is_by_strain else signal_speeds
    asked = f"the step would have to shrink to {step:.3g} s, below the smallest one, {smallest:.3g} s"
    body = max(bodies, key=lambda found: float(reason(found).max(initial=0.0)))
    if body.count == 0:
        return SimulationError(f"{when}: {asked} (time.smallest_step)")
    point, words = what_sets_the_step(body, reason)
    return failure_at(when, body, point, f"{asked} (time.smallest_step): {words}")
