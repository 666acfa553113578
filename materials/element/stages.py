"""Following a mixed control: in every step SciPy finds the strain rates behind the prescribed stresses.

Frame and density are as in `driver`.
"""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from grainlaw.materials.compilation import explained, make_single_step, pointwise_law
from grainlaw.materials.element.mixed import MixedControl, Stage
from grainlaw.materials.element.path import steps_of
from grainlaw.materials.element.point import Point, is_finite, strain_reached
from grainlaw.materials.element.specimen import Specimen
from grainlaw.materials.errors import SimulationError
from grainlaw.materials.tensor import SymmetricTensor, trace

# Relative to the largest initial or prescribed stress component.
STRESS_TOLERANCE = 1e-8

Array = NDArray[np.float64]


def follow_stages(specimen: Specimen, control: MixedControl, point: Point, stride: int) -> Iterator[Point]:
    """The point after every `stride` steps of the stages and after the last one.

    Raises SimulationError, with the time and the strain reached, if a prescribed stress cannot be reached or stress or
    density are not finite.
    """
    solver = StageSolver(specimen, control.time_step, point)
    step = 0
    for stage in control.stage:
        start, guess = np.array(point.stress), np.zeros(len(stage.stress_rate))
        for n in range(1, steps_of(stage.duration, control.time_step) + 1):
            step += 1
            target = start[stage.controlled] + n * control.time_step * np.array(list(stage.stress_rate.values()))
            point, guess = solver.advanced(point, stage, target, guess)
            point = point._replace(time=step * control.time_step)
            if step % stride == 0 or step == control.steps:
                yield point


class StageSolver:
    """One step of mixed control of a specimen, with scales taken from its initial state."""

    def __init__(self, specimen: Specimen, dt: float, point: Point) -> None:
        self.law, self.parameters, self.dt = specimen.law, specimen.parameters, dt
        self.single_step = make_single_step(pointwise_law(specimen.law))
        self.stress_scale = float(np.max(np.abs(point.stress)))
        speed = specimen.law.sound_speed(point.stress, point.density, point.state, specimen.parameters)
        self.modulus = point.density * speed * speed

    def advanced(self, point: Point, stage: Stage, target: Array, guess: Array) -> tuple[Point, Array]:
        """The point one step later, and its unknown strain rates over their scale, the first guess of the next step."""
        if not stage.controlled:
            return self._strained(point, stage), guess
        rate_scale = self._rate_scale(stage)

        def trial(unknown: Array) -> Point:
            rates = np.array(stage.prescribed)
            rates[stage.controlled] = unknown * rate_scale
            return self._moved(point, SymmetricTensor(*rates.tolist()))

        def residual(unknown: Array) -> Array:
            stress = np.array(trial(unknown).stress)[stage.controlled]
            return (stress - target) / (self.modulus * rate_scale * self.dt)

        try:
            found = root(residual, guess, options={"xtol": 1e-10}).x
            reached = trial(found)
            error = float(np.max(np.abs(np.array(reached.stress)[stage.controlled] - target)))
        except ArithmeticError:
            # Without a solution the iteration may run away until the law leaves the range of numbers.
            error = math.inf
        if not (
            error <= STRESS_TOLERANCE * max(self.stress_scale, float(np.max(np.abs(target)))) and is_finite(reached)
        ):
            step = round(point.time / self.dt) + 1
            raise SimulationError(
                f"{self.law.name}: stress {', '.join(stage.stress_rate)} cannot follow its control in step {step} "
                f"(t = {step * self.dt:g} s); the nearest found is {error:g} Pa off; {strain_reached(point)}"
            )
        return reached, found

    def _strained(self, point: Point, stage: Stage) -> Point:
        """The point one step later where every strain rate is prescribed."""
        try:
            moved = self._moved(point, stage.prescribed)
            reason = "" if is_finite(moved) else "stress or density not finite"
        except ArithmeticError as error:
            reason = str(error)
        if reason:
            step = round(point.time / self.dt) + 1
            raise SimulationError(
                f"{self.law.name}: {reason} in step {step} (t = {step * self.dt:g} s); {strain_reached(point)}"
            )
        return moved

    def _moved(self, point: Point, strain_rate: SymmetricTensor) -> Point:
        density = point.density * math.exp(-trace(strain_rate) * self.dt)
        stress, state = explained(
            self.law, self.single_step, point.stress, strain_rate, density, point.state, self.parameters, self.dt
        )
        strain = point.strain + self.dt * strain_rate
        return Point(point.time, stress, strain, strain_rate, density, state, point.search)

    def _rate_scale(self, stage: Stage) -> float:
        """A strain rate [1/s] of the size that the stage will see."""
        strain_rates = [abs(rate) for rate in stage.strain_rate.values()]
        elastic_rates = [abs(rate) / self.modulus for rate in stage.stress_rate.values()]
        return max(strain_rates + elastic_rates) or 1.0 / stage.duration
