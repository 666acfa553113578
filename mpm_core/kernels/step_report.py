"""What the passes over the points report of a step, put together for a body."""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.kernels.g2p import (
    HIGHEST_X,
    HIGHEST_Y,
    KINETIC_ENERGY,
    LOWEST_X,
    LOWEST_Y,
    MAX_SPEED,
    MOMENTUM_X,
    MOMENTUM_Y,
)
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stress_update import (
    INTERNAL_WORK,
    MAX_DIFFUSIVITY,
    MAX_INCREMENT,
    MAX_SIGNAL_SPEED,
)


class StepReport(NamedTuple):
    """A step of a body, or of several.

    lowest_x ... highest_y  corners of its bounding box [m]
    kinetic                 energy [J/m]
    momentum_x, momentum_y        momentum of the motion of the points [kg/s]
    internal_work           of the stress on the strain [J/m]
    fastest                 speed at which a point moved [m/s]
    signal_speed            largest sum of sound speed and speed [m/s]
    increment               largest volumetric strain of the motion [1]; NaN if anything is not finite
    diffusivity             largest viscosity over density [m2/s]
    """

    lowest_x: float
    highest_x: float
    lowest_y: float
    highest_y: float
    kinetic: float
    momentum_x: float
    momentum_y: float
    internal_work: float
    fastest: float
    signal_speed: float
    increment: float
    diffusivity: float


# A body of which nothing is awake.
_NOTHING = StepReport(math.inf, -math.inf, math.inf, -math.inf, *([0.0] * 8))


def step_report(transfer: NDArray[np.float64], stress: NDArray[np.float64]) -> StepReport:
    """The report of a body from those of its blocks."""
    if len(stress) == 0:
        return _NOTHING
    return StepReport(*_combined(transfer, stress))


def together(reports: list[StepReport]) -> StepReport:
    """The report of several bodies, at least one."""
    if len(reports) == 1:
        return reports[0]
    each: Any = StepReport._make(zip(*reports, strict=True))
    return StepReport(
        lowest_x=min(each.lowest_x),
        highest_x=max(each.highest_x),
        lowest_y=min(each.lowest_y),
        highest_y=max(each.highest_y),
        kinetic=sum(each.kinetic),
        momentum_x=sum(each.momentum_x),
        momentum_y=sum(each.momentum_y),
        internal_work=sum(each.internal_work),
        fastest=max(each.fastest),
        signal_speed=max(each.signal_speed),
        increment=max(each.increment),
        diffusivity=max(each.diffusivity),
    )


@njit(cache=True)
@named(CORE_MARK)
def _combined(transfer, stress):  # type: ignore[no-untyped-def]
    increment, signal_speed, diffusivity = 0.0, 0.0, 0.0
    for block in range(len(stress)):
        # not less, rather than greater: NaN has to come through
        if not stress[block, MAX_INCREMENT] <= increment:
            increment = stress[block, MAX_INCREMENT]
        if not stress[block, MAX_SIGNAL_SPEED] <= signal_speed:
            signal_speed = stress[block, MAX_SIGNAL_SPEED]
        if not stress[block, MAX_DIFFUSIVITY] <= diffusivity:
            diffusivity = stress[block, MAX_DIFFUSIVITY]
        if np.isnan(increment) or np.isnan(signal_speed) or np.isnan(diffusivity):
            break
    return (
        transfer[:, LOWEST_X].min(),
        transfer[:, HIGHEST_X].max(),
        transfer[:, LOWEST_Y].min(),
        transfer[:, HIGHEST_Y].max(),
        transfer[:, KINETIC_ENERGY].sum(),
        transfer[:, MOMENTUM_X].sum(),
        transfer[:, MOMENTUM_Y].sum(),
        stress[:, INTERNAL_WORK].sum(),
        transfer[:, MAX_SPEED].max(),
        signal_speed,
        increment,
        diffusivity,
    )
