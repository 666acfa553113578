"""Axis-aligned manufactured solution: a Neo-Hookean square whose edges slide on smooth walls while it is driven."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from materials.rheology import shear_modulus
from mpm_core.body import Body
from mpm_core.columns import AXX, AYY, LXX, LYY, SXX, SYY, VX, VY, X, Y
from mpm_core.simulation import Simulation
from validation.case import Case, Convergence, Effort, Evidence, Figure, Measurement, curve, upper_bound
from validation.scenes import advance, simulation_of

Array = NDArray[np.float64]

BAND, BAND_CELLS = 1e-2, 32
LEAST_ORDER = 1.8
YOUNGS_MODULUS, POISSON_RATIO, DENSITY = 1e4, 0.3, 1.0
BULK_MODULUS = YOUNGS_MODULUS / (3.0 * (1.0 - 2.0 * POISSON_RATIO))
SHEAR_MODULUS = shear_modulus(BULK_MODULUS, POISSON_RATIO)
LAME = BULK_MODULUS - 2.0 / 3.0 * SHEAR_MODULUS
SPEED = math.sqrt(YOUNGS_MODULUS / DENSITY)
AMPLITUDE = 0.05
PERIOD = 2.0 / SPEED
# The displacement along y runs half a period behind the one along x.
PHASES = np.array([[0.0], [math.pi]])
# Without decay of velocities, which would damp the motion.
UNDAMPED = 1e6


@dataclass(frozen=True)
class Resolution:
    """How a grid of cells is filled with points, and what is asked of the order on it."""

    label: str
    basis: str
    points_per_cell: int
    cells: dict[Effort, tuple[int, ...]]
    least_order: float | None


# Quadratic splines over 4 points per cell: quadrature shows where points cross cells, so their order is stated only.
RESOLUTIONS = (
    Resolution(
        "quadratic, 16 points per cell",
        "quadratic",
        16,
        {Effort.QUICK: (8, 16, 32), Effort.FULL: (8, 16, 32, 64)},
        LEAST_ORDER,
    ),
    Resolution(
        "cubic, 4 points per cell",
        "cubic",
        4,
        {Effort.QUICK: (8, 16, 32), Effort.FULL: (8, 16, 32, 64, 128)},
        LEAST_ORDER,
    ),
    Resolution(
        "quadratic, 4 points per cell",
        "quadratic",
        4,
        {Effort.QUICK: (8, 16, 32), Effort.FULL: (8, 16, 32, 64, 128)},
        None,
    ),
)


def displacement(places: Array, time: float) -> Array:
    """U = A sin(pi X) sin(c pi t + phase) of the places at the start, along each axis; shape (2, n) [m]."""
    return AMPLITUDE * np.sin(math.pi * places) * np.sin(SPEED * math.pi * time + PHASES)


def velocity(places: Array, time: float) -> Array:
    """Of the same places, shape (2, n) [m/s]."""
    rate = SPEED * math.pi
    return AMPLITUDE * rate * np.sin(math.pi * places) * np.cos(rate * time + PHASES)


def velocity_gradient_at_start(places: Array) -> Array:
    """The two diagonal components, shape (2, n) [1/s]."""
    return AMPLITUDE * math.pi * SPEED * math.pi * np.cos(math.pi * places) * np.cos(PHASES)


def stretch(places: Array, time: float) -> Array:
    """The two diagonal components of F, shape (2, n)."""
    return 1.0 + AMPLITUDE * math.pi * np.cos(math.pi * places) * np.sin(SPEED * math.pi * time + PHASES)


def body_force(places: Array, time: float) -> Array:
    """Acceleration b = d2u/dt2 - (1/rho_0) dP/dX with the first Piola-Kirchhoff stress P; shape (2, n) [m/s2].

    P_11 = G (F_1 - 1/F_1) + Lambda ln(F_1 F_2)/F_1 and dF_1/dX = -pi^2 u, so that
    dP_11/dX = -pi^2 u [G + (G + Lambda (1 - ln J))/F_1^2]; the same along y.
    """
    u, f = displacement(places, time), stretch(places, time)
    log_volume = np.log(f[0] * f[1])
    stiffness = SHEAR_MODULUS + (SHEAR_MODULUS + LAME * (1.0 - log_volume)) / f**2
    return math.pi**2 * u * (stiffness / DENSITY - SPEED**2)


def stress(places: Array, time: float) -> Array:
    """Cauchy stresses along x and y, shape (2, n) [Pa]."""
    f = stretch(places, time)
    volume_ratio = f[0] * f[1]
    return (SHEAR_MODULUS * (f**2 - 1.0) + LAME * np.log(volume_ratio)) / volume_ratio


def scene(cells: int, resolution: Resolution) -> dict[str, Any]:
    """The unit square between smooth walls."""
    return {
        "gravity": [0.0, 0.0],
        "grid": {"cell_size": 1.0 / cells, "upper": [1.0, 1.0]},
        "time": {"end": PERIOD},
        "transfer": {"time_constant": UNDAMPED, "basis": resolution.basis},
        "material": {"neo_hookean": {"bulk_modulus": BULK_MODULUS, "poisson_ratio": POISSON_RATIO}},
        "body": [
            {
                "material": "neo_hookean",
                "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [1.0, 1.0]},
                "density": DENSITY,
                "points_per_cell": resolution.points_per_cell,
            }
        ],
    }


@dataclass(frozen=True)
class Errors:
    """Largest root mean square errors over one period: of the place over the amplitude, of the stress over E."""

    displacement: float
    stress: float


def driven_square(cells: int, resolution: Resolution, force_factor: float = 1.0) -> Errors:
    """One period of the motion; a control multiplies the body force."""
    simulation = simulation_of(scene(cells, resolution))
    body = simulation.bodies[0]
    places = body.points[[X, Y]].copy()
    body.points[[VX, VY]] = velocity(places, 0.0)
    body.points[[LXX, LYY]] = body.points[[AXX, AYY]] = velocity_gradient_at_start(places)
    simulation.body_force = lambda moved, time: force_factor * body_force(places[:, moved.ids], time)
    found: list[tuple[float, float]] = []

    def observe(present: Simulation) -> None:
        found.append(_errors(body, places, present.time))

    advance(simulation, PERIOD, observe, intervals=20)
    return Errors(*(max(values) for values in zip(*found, strict=True)))


def _errors(body: Body, places: Array, time: float) -> tuple[float, float]:
    ordered = places[:, body.ids]
    off = body.points[[X, Y]] - ordered - displacement(ordered, time)
    off_stress = body.points[[SXX, SYY]] - stress(ordered, time)
    return (
        float(np.sqrt((off**2).sum(axis=0).mean())) / AMPLITUDE,
        float(np.sqrt((off_stress**2).sum(axis=0).mean())) / YOUNGS_MODULUS,
    )


def measurement(resolution: Resolution, errors: Errors) -> Measurement:
    """The error of the place on the grid of the band."""
    return upper_bound(f"displacement, {BAND_CELLS} cells, {resolution.label}", "1", errors.displacement, BAND)


def measure(effort: Effort) -> Evidence:
    """Three ways to fill grids of several sizes; the band holds for 32 cells."""
    measurements, orders, curves, notes = [], [], [], []
    for resolution in RESOLUTIONS:
        found = {cells: driven_square(cells, resolution) for cells in resolution.cells[effort]}
        sizes = tuple(1.0 / cells for cells in found)
        errors = tuple(one.displacement for one in found.values())
        orders.append(Convergence(resolution.label, "cell size [m]", sizes, errors, resolution.least_order))
        curves.append(curve(resolution.label, sizes, errors))
        if BAND_CELLS in found:
            measurements.append(measurement(resolution, found[BAND_CELLS]))
        stresses = ", ".join(f"{cells}: {one.stress:.2e}" for cells, one in found.items())
        notes.append(f"stress error over E, {resolution.label}, by cells: {stresses}")
    title = "Error of the displacement over the amplitude"
    figure = Figure(title, "cell size [m]", "error [1]", tuple(curves), logarithmic="xy")
    return Evidence(tuple(measurements), tuple(orders), (figure,), tuple(notes))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A body force 3 % too large."""
    resolution = RESOLUTIONS[1]
    return (measurement(resolution, driven_square(BAND_CELLS, resolution, force_factor=1.03)),)


CASE = Case(
    name="axis_aligned_solution",
    title="axis-aligned manufactured solution",
    proves="inertia, large strain, smooth walls and points that cross cells, together, to second order",
    reference="u = A sin(pi X) sin(c pi t), v = A sin(pi Y) sin(c pi t + pi), A = 0.05 m, c = sqrt(E/rho), E = 1e4 Pa, "
    "nu = 0.3, rho = 1 kg/m3 (Wallstedt & Guilkey 2008), with the body force that makes it exact",
    norm="largest root mean square distance from the exact place over one period, over A",
    mistake="body force 3 % too large",
    measure=measure,
    control=control,
)
