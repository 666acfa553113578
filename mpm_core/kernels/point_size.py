"""The size of a point: the edge of the square, in three dimensions of the cube, of its volume."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba.extending import register_jitable

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.space import Space


def make_size_of(space: Space, precision: str) -> Callable[..., Any]:
    """A function that gives the size of a point, which is no larger than at a least density."""
    access, in_3d, hoop = position_access(space, precision), space.axes == 3, space.hoop
    radius_of, density, mass_of = access.along, access.density, access.mass

    @register_jitable
    @named(f"{space.name}_{precision}_{CORE_MARK}")
    def size_of(storage, p, mass, least_density):  # type: ignore[no-untyped-def]
        volume = mass_of(storage, p, mass) / max(density(storage, p), least_density)
        if hoop:
            volume /= radius_of(storage, 0, p)
        return np.cbrt(volume) if in_3d else np.sqrt(volume)

    return size_of
