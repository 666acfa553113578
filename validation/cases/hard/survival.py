"""What a hard case must survive, and what was limited on the way.

The core clips nothing: a run that goes wrong stops. What it bounds (`output.bounded_points`) is counted at its end.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from grainlaw.materials import SimulationError
from grainlaw.mpm_core.output.bounded_points import limited
from grainlaw.mpm_core.output.observables import PileShape, shape_of
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Measurement, upper_bound
from grainlaw.validation.scenes import advance

SURVIVAL = "the run reaches its end with finite values and creates no energy"
NORM = "share of the time not reached; points not finite; energy created over energy released"

ENERGY_BAND = 1e-2
INTERVALS = 20
Observe = Callable[[Simulation], None]
Lead = Callable[[Simulation, float, Observe], None]


@dataclass(frozen=True)
class Trial:
    """One run of a hard case.

    missing         share of the time that was not reached
    not_finite      points with a value that is not finite
    created         largest energy that came from nowhere, over the energy released
    shape           the material at the end
    steps           number of steps
    limited         counts of what was bounded, by name
    message         why the run stopped; empty if it did not
    """

    missing: float
    not_finite: int
    created: float
    shape: PileShape
    steps: int
    limited: dict[str, int]
    message: str


def in_stable_steps(simulation: Simulation, end: float, observe: Observe) -> None:
    """Lead a simulation to `end` [s] as a run does."""
    advance(simulation, end, observe, INTERVALS)


def trial(simulation: Simulation, end: float, lead: Lead = in_stable_steps) -> Trial:
    """Lead a simulation to `end` [s]; a run that stops is a result too."""
    created = [0.0]
    message = ""
    try:
        lead(simulation, end, lambda present: created.append(created_energy(present)))
    except SimulationError as error:
        message = str(error)
    return Trial(
        missing=max(0.0, 1.0 - simulation.time / end),
        not_finite=sum(int((~np.isfinite(body.points)).any(axis=0).sum()) for body in simulation.bodies),
        created=max(created),
        shape=shape_of(simulation),
        steps=simulation.steps,
        limited=limited(simulation),
        message=message,
    )


def created_energy(simulation: Simulation) -> float:
    """Energy made over the energy released so far (`Ledger.made`); zero where none was."""
    ledger = simulation.ledger
    return ledger.made(simulation.elastic_energy()) / ledger.released if ledger.released > 0.0 else 0.0


def survival(label: str, found: Trial) -> tuple[Measurement, ...]:
    """The end is reached, all is finite, no energy comes from nowhere."""
    return (
        upper_bound(f"{label}: time not reached", "1", found.missing, 0.0),
        upper_bound(f"{label}: points that are not finite", "1", found.not_finite, 0.0),
        upper_bound(f"{label}: energy created over released", "1", found.created, ENERGY_BAND),
    )


def survivals(trials: Mapping[str, Trial]) -> tuple[Measurement, ...]:
    """Of several runs by label."""
    return tuple(measurement for label, found in trials.items() for measurement in survival(label, found))


def notes(trials: Mapping[str, Trial]) -> tuple[str, ...]:
    """One line for each run: shape, steps, what was limited, why it stopped."""
    return tuple(_note(label, found) for label, found in trials.items())


def _note(label: str, found: Trial) -> str:
    counts = ", ".join(
        f"{count} {name.removeprefix('points_').replace('_', ' ')}" for name, count in found.limited.items()
    )
    shape = f"half width {found.shape.runout:.3f} m, top {found.shape.height:.3f} m"
    stopped = f"; stopped: {found.message}" if found.message else ""
    return f"{label}: {shape}, {found.steps} steps; points {counts}{stopped}"
