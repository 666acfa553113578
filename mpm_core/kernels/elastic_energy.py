"""The elastic energy of a body: the law's own energy per mass, summed over the points when it is asked for."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from grainlaw.materials.compilation import PointwiseLaw, explained, named, pointwise_law
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.kernels.kinematics import kinematics
from grainlaw.mpm_core.kernels.law_at_points import make_state_access
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.rows import rows_of
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.layout import layout_of
from grainlaw.mpm_core.space import Space


@cache
def _sum_over_points(space: Space, law: PointwiseLaw, precision: str) -> Callable[..., Any]:
    """A kernel that sums a law's energy over the points, in their order."""
    stored_energy: Any = law.stored_energy
    parameter_class = law.parameters
    mark = f"{space.name}_{precision}_{law.mark}_{CORE_MARK}"
    load, _ = make_state_access(space, law.state, mark)
    stress_at, mass_of = kinematics(space, "double").stress, position_access(space, precision).mass
    density = layout_of(space).density
    all_rows = (0.0,) * (layout_of(space).first_state + len(law.state._fields))

    @njit(error_model="numpy", cache=True)
    @named(mark)
    def sum_of_energies(storage, count, point_mass, parameters):  # type: ignore[no-untyped-def]
        rows, law_parameters, total = rows_of(storage, all_rows), parameter_class(*parameters), 0.0
        for p in range(count):
            energy = stored_energy(stress_at(rows, p), np.float64(rows[density][p]), load(rows, p), law_parameters)
            total += mass_of(storage, p, point_mass) * energy
        return total

    return sum_of_energies


def elastic_energy(body: Body, points: NDArray[np.float64] | None = None) -> float:
    """The elastic energy of a body, or of some of its points [J and the space's amount].

    `points` are like `Body.points`. NaN if the law does not state its energy.

    Raises InputError if the law's energy does not compile.
    """
    if body.law.stored_energy is None:
        return math.nan
    kernel = _sum_over_points(body.space, pointwise_law(body.law), body.precision)
    storage, count = (body.storage, body.count) if points is None else (points, points.shape[1])
    return float(explained(body.law, kernel, storage, count, body.point_mass, tuple(body.parameters)))
