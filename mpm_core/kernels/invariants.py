"""Invariants of the stress at all points."""

from collections.abc import Callable
from functools import cache
from typing import Any

from numba import njit

from grainlaw.materials import SymmetricTensor
from grainlaw.materials.compilation import named, registered
from grainlaw.mpm_core.kernels.kinematics import kinematics
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.space import Space


@cache
def over_stress(space: Space, function: Callable[[SymmetricTensor], float]) -> Callable[..., Any]:
    """A kernel that evaluates an invariant of the stress at all points."""
    invariant, stress_at = registered(function), kinematics(space, "double").stress

    @njit(cache=True)
    @named(f"{space.name}_{function.__name__}_{CORE_MARK}")
    def evaluate(points, values):  # type: ignore[no-untyped-def]
        for p in range(points.shape[1]):
            values[p] = invariant(stress_at(points, p))

    return evaluate
