"""Manufactured solution in axisymmetry: a Neo-Hookean cylinder between smooth walls while it is driven.

The radius follows r = R + A sin(pi R) sin(c pi t), the height z = Z - A sin(pi Z) sin(c pi t), A = 0.05 m, c =
sqrt(E/rho), as in the axis-aligned solution of the square (Wallstedt & Guilkey 2008, J. Comput. Phys. 227).
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Measurement, upper_bound
from grainlaw.validation.cases.exact.driven_square import (
    AMPLITUDE,
    BULK_MODULUS,
    COMPARISONS,
    DENSITY,
    LAME,
    PERIOD,
    POISSON_RATIO,
    SHEAR_MODULUS,
    SPEED,
    UNDAMPED,
)
from grainlaw.validation.scenes import advance, block, simulation_of

Array = NDArray[np.float64]

BAND, BAND_CELLS = 2e-2, 16
LEAST_ORDER = 1.9
POINTS_PER_CELL = 16
CELLS = {Effort.QUICK: (8, 16), Effort.FULL: (8, 16, 32, 64)}
RATE = SPEED * math.pi
# The height moves against the radius.
SIGNS = np.array([[1.0], [-1.0]])


class Stretches(NamedTuple):
    """The principal stretches: along the radius, around the axis, and up, each of shape (n,)."""

    radial: Array
    around: Array
    up: Array


def displacement(places: Array, time: float) -> Array:
    """Of the places at the start, shape (2, n) [m]."""
    return AMPLITUDE * np.sin(math.pi * places) * SIGNS * math.sin(RATE * time)


def stretches(places: Array, time: float) -> Stretches:
    """Of the places at the start."""
    radial, up = 1.0 + AMPLITUDE * math.pi * np.cos(math.pi * places) * SIGNS * math.sin(RATE * time)
    return Stretches(radial, 1.0 + displacement(places, time)[0] / places[0], up)


def body_force(places: Array, time: float, around: float = 1.0) -> Array:
    """Acceleration b = d2u/dt2 - Div P/rho_0 with the first Piola-Kirchhoff stress P; shape (2, n) [m/s2].

    P_i = G (F_i - 1/F_i) + Lambda ln(J)/F_i. Along the radius Div P = dP_r/dR + (P_r - P_theta)/R with dF_theta/dR =
    (F_r - F_theta)/R; along the height dP_z/dZ. A control multiplies what comes from `around` the axis.
    """
    radius, u, f = places[0], displacement(places, time), stretches(places, time)
    log_volume = np.log(f.radial * f.around * f.up)
    curved = -(math.pi**2) * u

    def piola(stretch: Array) -> Array:
        return SHEAR_MODULUS * (stretch - 1.0 / stretch) + LAME * log_volume / stretch

    def own_slope(stretch: Array) -> Array:
        return SHEAR_MODULUS + (SHEAR_MODULUS + LAME * (1.0 - log_volume)) / stretch**2

    around_changes = (f.radial - f.around) / radius
    of_hoop = LAME * around_changes / (f.around * f.radial) + (piola(f.radial) - piola(f.around)) / radius
    divergence = np.array([own_slope(f.radial) * curved[0] + around * of_hoop, own_slope(f.up) * curved[1]])
    return np.asarray(-(RATE**2) * u - divergence / DENSITY)


class DrivenCylinder:
    """The unit cylinder at the start of its motion; a control multiplies the force from around the axis."""

    def __init__(self, cells: int, around: float = 1.0) -> None:
        self.simulation = simulation_of(_scene(cells))
        self.body = self.simulation.bodies[0]
        self.places = self.body.positions.copy()
        self.around = around
        rate = AMPLITUDE * RATE * SIGNS
        self.body.velocity = rate * np.sin(math.pi * self.places)
        slopes = rate * math.pi * np.cos(math.pi * self.places)
        for axis in range(2):
            self.body.velocity_gradient[axis, axis] = self.body.affine[axis, axis] = slopes[axis]
        self.simulation.body_force = self.force

    def force(self, body: Body, time: float) -> Array:
        """Acceleration of the points in their present order, shape (2, n) [m/s2]."""
        return body_force(self.places[:, body.ids], time, self.around)

    def error_of_a_period(self) -> float:
        """The largest root mean square error of the place over one period, over the amplitude."""
        found: list[float] = []
        advance(self.simulation, PERIOD, lambda present: found.append(self._error(present)), intervals=COMPARISONS)
        return max(found)

    def _error(self, present: Simulation) -> float:
        places, masses = self.places[:, self.body.ids], self.body.masses
        off = self.body.positions - places - displacement(places, present.time)
        return math.sqrt(float(((off**2).sum(axis=0) * masses).sum() / masses.sum())) / AMPLITUDE


def _scene(cells: int) -> dict[str, Any]:
    return {
        "space": "axisymmetric",
        "gravity": [0.0, 0.0],
        "grid": {"cell_size": 1.0 / cells, "upper": [1.0, 1.0]},
        "time": {"end": PERIOD},
        "transfer": {"time_constant": UNDAMPED},
        "material": {"neo_hookean": {"bulk_modulus": BULK_MODULUS, "poisson_ratio": POISSON_RATIO}},
        "body": [
            {
                "material": "neo_hookean",
                "shape": block([0.0, 0.0], [1.0, 1.0]),
                "density": DENSITY,
                "points_per_cell": POINTS_PER_CELL,
            }
        ],
    }


def measurement(error: float) -> Measurement:
    """The error of the place on the grid of the band."""
    return upper_bound(f"displacement, {BAND_CELLS} cells", "1", error, BAND)


def measure(effort: Effort) -> Evidence:
    """Grids of several sizes."""
    found = {cells: DrivenCylinder(cells).error_of_a_period() for cells in CELLS[effort]}
    sizes = tuple(1.0 / cells for cells in found)
    order = Convergence("displacement", "cell size [m]", sizes, tuple(found.values()), LEAST_ORDER)
    return Evidence((measurement(found[BAND_CELLS]),), (order,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The force from around the axis 10 % too large."""
    return (measurement(DrivenCylinder(BAND_CELLS, around=1.1).error_of_a_period()),)


CASE = Case(
    name="driven_cylinder",
    title="manufactured solution in axisymmetry",
    proves="inertia, large strain and the stress around the axis, from the axis to a smooth wall, to second order",
    reference="r = R + A sin(pi R) sin(c pi t), z = Z - A sin(pi Z) sin(c pi t), A = 0.05 m, c = sqrt(E/rho), with the "
    "body force that makes it exact",
    norm="largest root mean square distance from the exact place over one period, weighed by mass, over A",
    mistake="the part of the body force that comes from around the axis 10 % too large",
    measure=measure,
    control=control,
)
