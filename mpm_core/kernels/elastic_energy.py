"""The elastic energy of a body: the law's own energy per mass, summed over the points when it is asked for."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import njit

from grainlaw.materials.compilation import PointwiseLaw, explained, named, pointwise_law
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.kernels.law_at_points import make_state_access, point_access
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.layout import DENSITY, X


@cache
def _sum_over_points(law: PointwiseLaw) -> Callable[..., Any]:
    """A kernel that sums a law's energy per mass over the points, in their order."""
    stored_energy: Any = law.stored_energy
    parameter_class = law.parameters
    mark = f"{law.mark}_{CORE_MARK}"
    load, _ = make_state_access(law.state, mark)
    stress_at, _ = point_access("double")

    @njit(error_model="numpy", cache=True)
    @named(mark)
    def sum_of_energies(rows, parameters):  # type: ignore[no-untyped-def]
        law_parameters = parameter_class(*parameters)
        total = 0.0
        for p in range(len(rows[X])):
            total += stored_energy(stress_at(rows, p), np.float64(rows[DENSITY][p]), load(rows, p), law_parameters)
        return total

    return sum_of_energies


def elastic_energy(body: Body) -> float:
    """The elastic energy of a body per width [J/m]; NaN if its law does not state its energy.

    Raises InputError if the law's energy does not compile.
    """
    if body.law.stored_energy is None:
        return math.nan
    kernel = _sum_over_points(pointwise_law(body.law))
    return body.point_mass * float(explained(body.law, kernel, tuple(body.points), tuple(body.parameters)))
