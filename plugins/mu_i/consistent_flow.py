"""The inertial number of a step: that I whose plastic shear leaves as much stress as the strength at I is.

The excess of the trial stress over what I uses up and what it can carry is positive at I = 0, or the step is elastic,
and negative once the trial shear has all become plastic: the root is bracketed, and found by the secant method from the
I of the step before, with bisection wherever that leaves the bracket or hardly gains. Below the loosest packing that
flows, compaction can take the pressure faster than any I uses up the shear; then there is no root, and the grains part.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from grainlaw.materials import pointwise

# The same as the tolerance of a search, where round-off keeps I from more.
LARGEST_ERROR = 1e-6
MAXIMUM_ITERATIONS = 200
# Beyond it no pressure is left: at 1000 1/s and 15 mm less than 1e-6 Pa.
LARGEST_NUMBER = 1e6


class Flow(NamedTuple):
    """The end of a step with an assumed I.

    number      I
    contact     what presses the grains, in the measure of the law: pressure [Pa] or elastic strain; zero if they parted
    strength    shear stress that the grains can carry [Pa]
    excess      trial shear stress that I leaves over [Pa]
    """

    number: float
    contact: float
    strength: float
    excess: float


PARTED, NOT_FOUND = Flow(0.0, 0.0, 0.0, 0.0), Flow(math.nan, math.nan, math.nan, math.nan)


def consistent_flow_of(flow_at: Callable[[float, Any, Any], Flow], tolerance: float) -> Callable[..., Flow]:
    """The search for a law: `flow_at(number, increment, parameters)` is the end of the step if its I is `number`.

    `tolerance` is a share of the increment's `trial_shear_stress`.
    """

    @pointwise
    def consistent_flow(increment: Any, guess: float, parameters: Any) -> Flow:
        """The step whose shear stress is the strength at its own I, from the I of the step before.

        Without contact where there is no such number, NaN where it is not found.
        """
        still = flow_at(0.0, increment, parameters)
        if still.excess <= 0.0:
            return still
        lower, upper = 0.0, math.inf
        last, flow = still, flow_at(max(guess, 1e-6), increment, parameters)
        largest_excess = tolerance * increment.trial_shear_stress
        for _ in range(MAXIMUM_ITERATIONS):
            if abs(flow.excess) <= largest_excess:
                return flow
            if flow.excess > 0.0:
                lower = flow.number
            else:
                upper = flow.number
            if upper == math.inf and lower > LARGEST_NUMBER:
                return PARTED
            trial = 0.5 * (lower + upper) if upper < math.inf else 10.0 * lower
            if abs(flow.excess) < 0.5 * abs(last.excess):
                secant = flow.number + flow.excess * (flow.number - last.number) / (last.excess - flow.excess)
                trial = secant if lower < secant < upper else trial
            if trial in (lower, upper):
                break
            last, flow = flow, flow_at(trial, increment, parameters)
        return flow if abs(flow.excess) <= LARGEST_ERROR * increment.trial_shear_stress else NOT_FOUND

    return consistent_flow
