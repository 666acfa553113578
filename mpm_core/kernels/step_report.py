"""What the passes over the points report of a step, put together for a body."""

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.kernels.g2p import HIGHEST, KINETIC_ENERGY, LOWEST, MAX_SPEED, MOMENTUM, OF_AXES, PER_AXIS
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.kernels.stress_update import (
    INTERNAL_WORK,
    MAX_DIFFUSIVITY,
    MAX_INCREMENT,
    MAX_SIGNAL_SPEED,
)


class StepReport(NamedTuple):
    """A step of a body, or of several; energies and momenta in the amounts of the space.

    lowest, highest  corners of its bounding box [m]
    momentum         of the motion of the points [kg m/s]
    kinetic          energy [J]
    fastest          speed at which a point moved [m/s]
    internal_work    of the stress on the strain [J]
    signal_speed     largest sum of sound speed and speed [m/s]
    increment        largest volumetric strain of the motion [1]; NaN if anything is not finite
    diffusivity      largest viscosity over density [m2/s]
    """

    lowest: tuple[float, ...]
    highest: tuple[float, ...]
    momentum: tuple[float, ...]
    kinetic: float
    fastest: float
    internal_work: float
    signal_speed: float
    increment: float
    diffusivity: float


def step_report(transfer: NDArray[np.float64], stress: NDArray[np.float64]) -> StepReport:
    """The report of a body from those of its blocks; nothing moves where nothing is awake."""
    axes = (transfer.shape[1] - OF_AXES) // PER_AXIS
    if len(stress) == 0:
        return StepReport((math.inf,) * axes, (-math.inf,) * axes, (0.0,) * axes, *([0.0] * 6))
    combined = _combined(transfer, stress, axes).tolist()
    lowest, highest, momentum = (tuple(combined[axes * which : axes * (which + 1)]) for which in range(3))
    return StepReport(lowest, highest, momentum, *combined[3 * axes :])


def together(reports: list[StepReport]) -> StepReport:
    """The report of several bodies, at least one."""
    if len(reports) == 1:
        return reports[0]
    each: Any = StepReport._make(zip(*reports, strict=True))
    return StepReport(
        lowest=tuple(map(min, zip(*each.lowest, strict=True))),
        highest=tuple(map(max, zip(*each.highest, strict=True))),
        momentum=tuple(map(sum, zip(*each.momentum, strict=True))),
        kinetic=sum(each.kinetic),
        fastest=max(each.fastest),
        internal_work=sum(each.internal_work),
        signal_speed=max(each.signal_speed),
        increment=max(each.increment),
        diffusivity=max(each.diffusivity),
    )


@register_jitable
def _larger(value, largest):  # type: ignore[no-untyped-def]
    """The larger of two numbers; NaN comes through."""
    return value if value > largest or np.isnan(value) else largest


# Plain loops: the compiler takes ten times as long for NumPy's reductions of columns.
@njit(cache=True)
@named(CORE_MARK)
def _combined(transfer, stress, axes):  # type: ignore[no-untyped-def]
    """The numbers of a report one after another, the first three for each axis."""
    combined = np.zeros(3 * axes + 6)
    lowest, highest, momentum, rest = (
        combined[:axes],
        combined[axes : 2 * axes],
        combined[2 * axes :],
        combined[3 * axes :],
    )
    lowest[:], highest[:] = math.inf, -math.inf
    for block in range(len(transfer)):
        for axis in range(axes):
            first = OF_AXES + PER_AXIS * axis
            lowest[axis] = -_larger(-transfer[block, first + LOWEST], -lowest[axis])
            highest[axis] = _larger(transfer[block, first + HIGHEST], highest[axis])
            momentum[axis] += transfer[block, first + MOMENTUM]
        rest[0] += transfer[block, KINETIC_ENERGY]
        rest[1] = _larger(transfer[block, MAX_SPEED], rest[1])
    for block in range(len(stress)):
        rest[2] += stress[block, INTERNAL_WORK]
        rest[3] = _larger(stress[block, MAX_SIGNAL_SPEED], rest[3])
        rest[4] = _larger(stress[block, MAX_INCREMENT], rest[4])
        rest[5] = _larger(stress[block, MAX_DIFFUSIVITY], rest[5])
    return combined
