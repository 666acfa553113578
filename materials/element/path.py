"""A loading path of one point: the strain rate of every step, and the one stress measure that may be held instead."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials.errors import InputError
from grainlaw.materials.tensor import SymmetricTensor, isotropic

NOTHING = isotropic(0.0)
MAXIMUM_STEPS = 100_000_000


@dataclass(frozen=True)
class LoadingPath:
    """In step n, D = direction * rates[n] + x * free, where x is such that held : sigma = target at its end.

    dt         time step [s]
    rates      strain rate of each step [1/s], shape (steps,)
    direction  the prescribed strain rate per unit of `rates` [-]
    free       the strain rate per unit of x [-]; zero where every component is prescribed and there is no x
    held       the linear measure of stress that x controls [-], signed so that held : sigma grows with x
    target     its value [Pa]
    held_name  its name in messages
    """

    dt: float
    rates: NDArray[np.float64]
    direction: SymmetricTensor
    free: SymmetricTensor = NOTHING
    held: SymmetricTensor = NOTHING
    target: float = 0.0
    held_name: str = ""

    @property
    def steps(self) -> int:
        """The number of steps."""
        return self.rates.size


def steps_of(duration: float, dt: float) -> int:
    """The number of steps of dt [s] that fill a duration [s]. Raises InputError for none or unreasonably many."""
    steps = duration / dt
    if not 0.5 < steps < MAXIMUM_STEPS + 0.5:
        raise InputError(f"{duration:g} s in steps of {dt:g} s make {steps:.0f} steps; allowed: 1 to {MAXIMUM_STEPS}")
    return round(steps)


def constant_rate(strain: float, strain_rate: float, dt: float) -> NDArray[np.float64]:
    """The rates [1/s] that reach a strain [-] in steps of about strain_rate * dt; shape (steps,)."""
    steps = steps_of(strain / strain_rate, dt)
    return np.full(steps, strain / (steps * dt))
