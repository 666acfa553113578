"""The law under test with one of its parameter sets, and the paths of strain along which it is tried."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import Law, ParameterSet, SymmetricTensor, contraction, isotropic, trace

Array = NDArray[np.float64]

LARGEST_PRESSURE = 1000.0
# The initial pressure strains a stiff law by no more than this.
LARGEST_PRESSURE_STRAIN = 0.01
DT = 1e-2


class PointState(NamedTuple):
    """Stress [Pa], density [kg/m3] and the law's state of a point."""

    stress: SymmetricTensor
    density: float
    state: Any


class Call(NamedTuple):
    """One update: where it began, strain rate [1/s], step [s], and where it ended."""

    start: PointState
    strain_rate: SymmetricTensor
    dt: float
    end: PointState


@dataclass(frozen=True, eq=False)
class Subject:
    """A law with one of its parameter sets; `effort` multiplies the number of paths, steps and draws."""

    law: Law
    set_name: str
    effort: int

    @property
    def parameter_set(self) -> ParameterSet:
        """The parameter set."""
        return self.law.parameter_sets[self.set_name]

    @property
    def parameters(self) -> Any:
        """Its values, the law's NamedTuple."""
        return self.parameter_set.parameters

    @cached_property
    def pressure(self) -> float:
        """A pressure [Pa] under which the law is strained little."""
        return min(LARGEST_PRESSURE, LARGEST_PRESSURE_STRAIN * self.stiffness(self.at_rest(LARGEST_PRESSURE)))

    @cached_property
    def elastic_strain(self) -> float:
        """Strain by which this pressure comes and goes."""
        return self.pressure / self.stiffness(self.at_rest(self.pressure))

    def at_rest(self, pressure: float) -> PointState:
        """The initial state under an isotropic pressure [Pa]."""
        stress = isotropic(-pressure)
        density = self.parameter_set.density(max(pressure, 1e-3 * LARGEST_PRESSURE), self.parameters)
        return PointState(stress, density, self.law.initial_state(stress, density, self.parameters))

    def stiffness(self, point: PointState) -> float:
        """Rho c^2 [Pa] with the law's own speed of sound."""
        speed = self.law.sound_speed(*point, self.parameters)
        return point.density * speed * speed

    def moved(self, point: PointState, strain_rate: SymmetricTensor, dt: float = DT) -> PointState:
        """The point after one step; d(ln rho) = -tr D dt exactly."""
        density = point.density * math.exp(-trace(strain_rate) * dt)
        stress, state = self.law.update(point.stress, strain_rate, density, point.state, self.parameters, dt)
        return PointState(stress, density, state)

    @cached_property
    def calls(self) -> tuple[Call, ...]:
        """The updates of random paths that compress, shear, open and close the point."""
        found = []
        for seed in range(self.effort):
            point = self.at_rest(self.pressure)
            for strain_rate in random_strain_rates(100, seed):
                end = self.moved(point, strain_rate)
                found.append(Call(point, strain_rate, DT, end))
                point = end
        return tuple(found)

    def work(self, point: PointState, increments: Array, dt: float) -> Iterator[tuple[PointState, float]]:
        """The point after each strain increment, shape (steps, 6), and the work done [J per m3 at first]."""
        reference = point.density
        for increment in increments:
            strain = SymmetricTensor(*increment.tolist())
            end = self.moved(point, strain / dt, dt)
            mean = 0.5 * (
                contraction(point.stress, strain) / point.density + contraction(end.stress, strain) / end.density
            )
            point = end
            yield point, reference * mean


def random_strain_rates(steps: int, seed: int) -> Iterator[SymmetricTensor]:
    """Increments of 1e-6 to 1e-2 in random directions, with compression and extension in turn [1/s]."""
    random = np.random.default_rng(seed)
    sizes = 10.0 ** random.uniform(-6.0, -2.0, steps)
    drift = np.where(np.arange(steps) // 25 % 2 == 0, -0.5, 0.3)[:, None] * np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    for row in (random.standard_normal((steps, 6)) + drift) * sizes[:, None] / DT:
        yield SymmetricTensor(*row.tolist())


def flowing_strain_rates(steps: int) -> Array:
    """Shear of 1e-4 per step with a tenth of it in random directions [1/s], shape (steps, 6): a point in a flow."""
    shear = np.array([0.0, 0.0, 0.0, 1e-4, 0.0, 0.0])
    return (shear + 1e-5 * np.random.default_rng(0).standard_normal((steps, 6))) / DT


def largest_difference(one: tuple[float, ...], other: tuple[float, ...], scale: float) -> float:
    """Of any component, relative to the larger of the two tuples' components and the scale."""
    size = max([scale, *(abs(value) for value in (*one, *other))])
    return max((abs(a - b) for a, b in zip(one, other, strict=True)), default=0.0) / (size or 1.0)
