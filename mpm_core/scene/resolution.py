"""What single precision leaves of a stress that is small beside the stiffness.

A pressure that follows from the density is a difference of numbers near one, kept to rho c^2 times the rounding of
a single. A scene whose stresses are not far above that is refused.
"""

import math
from collections.abc import Sequence

import numpy as np

from grainlaw.materials import InputError
from grainlaw.mpm_core.body import Body

ROUNDING = float(np.finfo(np.float32).eps) / 2.0
# Of the stress that a body is under.
LARGEST_SHARE = 1e-2


def refuse_coarse_stress(
    bodies: Sequence[Body], signals: Sequence[tuple[float, float]], gravity: tuple[float, ...]
) -> None:
    """Raises InputError for a body in single precision whose stress [Pa] would be kept too coarsely.

    `signals` are the largest signal speed c + |v| and the largest |v| of each body's points at the start [m/s].
    """
    for number, (body, (fastest, speed)) in enumerate(zip(bodies, signals, strict=True)):
        if body.precision == "double":
            continue
        stress = typical_stress(body, math.hypot(*gravity))
        kept = ROUNDING * body.initial_density * (fastest - speed) ** 2
        if kept > LARGEST_SHARE * stress > 0.0:
            raise InputError(
                f"precision = 'single': the stress of body.{number} ({body.law.name}) would be kept to {kept:.2g} Pa, "
                f"its stiffness times {ROUNDING:.0e}, and is about {stress:.2g} Pa; allowed: {LARGEST_SHARE:.0%} of "
                "that; use 'double', or a smaller stiffness"
            )


def typical_stress(body: Body, gravity: float) -> float:
    """The larger of initial stress and weight of the body [Pa]; zero if it has neither."""
    height = float(np.ptp(body.positions, axis=1).max())
    in_plane = body.stress[: len(body.positions)]
    return max(float(np.abs(in_plane).max()), body.initial_density * gravity * height)
