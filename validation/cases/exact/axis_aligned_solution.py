"""Axis-aligned manufactured solution: a Neo-Hookean square whose edges slide on smooth walls while it is driven."""

from dataclasses import dataclass

from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.cases.exact.driven_square import DrivenSquare, Errors

BAND, BAND_CELLS = 1e-2, 32
LEAST_ORDER = 1.8


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


def errors_of(cells: int, resolution: Resolution, force_factor: float = 1.0) -> Errors:
    """One period of the motion."""
    settings = {"transfer": {"basis": resolution.basis}}
    return DrivenSquare(cells, resolution.points_per_cell, settings, force_factor).errors_of_a_period()


def measurement(resolution: Resolution, errors: Errors) -> Measurement:
    """The error of the place on the grid of the band."""
    return upper_bound(f"displacement, {BAND_CELLS} cells, {resolution.label}", "1", errors.displacement, BAND)


def measure(effort: Effort) -> Evidence:
    """Three ways to fill grids of several sizes; the band holds for 32 cells."""
    measurements, orders, curves, notes = [], [], [], []
    for resolution in RESOLUTIONS:
        found = {cells: errors_of(cells, resolution) for cells in resolution.cells[effort]}
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
    return (measurement(resolution, errors_of(BAND_CELLS, resolution, force_factor=1.03)),)


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
