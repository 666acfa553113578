"""What one update of a law costs, on states that flow: for comparison, nothing depends on it."""

import time
from functools import cache
from typing import Any

import numpy as np
from numba import njit

from materials.compilation import named, pointwise_law
from materials.law import Law
from materials.tensor import SymmetricTensor
from mpm_core.body import Body
from mpm_core.columns import DENSITY, FIRST_STATE, LXX, LXY, LYX, LYY, SXX, SXY, SYY, SZZ

POINTS, STEPS, REPEATS = 100, 500, 3
# Points that hardly move are elastic, which is cheaper.
SMALLEST_SHEAR_RATE = 0.5


@cache
def compiled_path(law: Law) -> Any:
    """Many updates of one point at one strain rate."""
    compiled = pointwise_law(law)
    update = compiled.update

    @njit(cache=True, error_model="numpy")
    @named(compiled.mark)
    def path(stress, strain_rate, density, state, parameters, dt, steps):  # type: ignore[no-untyped-def]
        for _ in range(steps):
            stress, state = update(stress, strain_rate, density, state, parameters, dt)
        return stress

    return path


def flowing_points(body: Body) -> list[tuple[SymmetricTensor, SymmetricTensor, float, Any]]:
    """Stress [Pa], deviatoric strain rate [1/s], density [kg/m3] and state of points that carry stress and flow."""
    points = body.points
    shear_rate = 0.5 * np.hypot(points[LXX] - points[LYY], points[LXY] + points[LYX])
    flowing = np.flatnonzero((points[SYY] < 0.0) & (shear_rate > SMALLEST_SHEAR_RATE))
    chosen = flowing[:: max(1, len(flowing) // POINTS)]
    found = []
    for column in points[:, chosen].T.tolist():
        mean = (column[LXX] + column[LYY]) / 3.0
        rate = SymmetricTensor(
            column[LXX] - mean, column[LYY] - mean, -mean, 0.5 * (column[LXY] + column[LYX]), 0.0, 0.0
        )
        stress = SymmetricTensor(column[SXX], column[SYY], column[SZZ], column[SXY], 0.0, 0.0)
        state = body.law.state(*column[FIRST_STATE : FIRST_STATE + len(body.law.state._fields)])
        found.append((stress, rate, column[DENSITY], state))
    return found


def nanoseconds_per_update(body: Body, dt: float) -> float:
    """Processor time [ns] of one compiled update, as the points flow on for 500 steps of dt [s] at constant volume.

    The best of three repeats; NaN if no point flows.
    """
    path, points = compiled_path(body.law), flowing_points(body)
    if not points:
        return float("nan")
    times = []
    for repeat in range(REPEATS + 1):
        start = time.process_time()
        for stress, rate, density, state in points:
            path(stress, rate, density, state, body.parameters, dt, STEPS if repeat else 1)
        times.append(time.process_time() - start)
    # The first pass only compiles.
    return min(times[1:]) / (len(points) * STEPS) * 1e9
