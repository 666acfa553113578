"""Manufactured solution in three dimensions: a Neo-Hookean cube between smooth walls while it is driven."""

from grainlaw.mpm_core.space import THREE_D
from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Measurement, upper_bound
from grainlaw.validation.cases.exact.driven_square import DrivenSquare, Errors

BAND, BAND_CELLS = 1e-1, 8
LEAST_ORDER = 1.9
POINTS_PER_CELL = 27
CELLS = {Effort.QUICK: (4, 8), Effort.FULL: (4, 8, 16)}


def errors_of(cells: int, force_factor: float = 1.0) -> Errors:
    """One period of the motion."""
    return DrivenSquare(cells, POINTS_PER_CELL, {}, force_factor, space=THREE_D).errors_of_a_period()


def measurement(errors: Errors) -> Measurement:
    """The error of the place on the grid of the band."""
    return upper_bound(f"displacement, {BAND_CELLS} cells", "1", errors.displacement, BAND)


def measure(effort: Effort) -> Evidence:
    """Grids of several sizes; the band holds for 8 cells."""
    found = {cells: errors_of(cells) for cells in CELLS[effort]}
    sizes = tuple(1.0 / cells for cells in found)
    order = Convergence(
        "displacement", "cell size [m]", sizes, tuple(one.displacement for one in found.values()), LEAST_ORDER
    )
    stresses = ", ".join(f"{cells}: {one.stress:.2e}" for cells, one in found.items())
    return Evidence((measurement(found[BAND_CELLS]),), (order,), notes=(f"stress error over E by cells: {stresses}",))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A body force 5 % too large."""
    return (measurement(errors_of(BAND_CELLS, force_factor=1.05)),)


CASE = Case(
    name="driven_cube",
    title="manufactured solution in 3D",
    proves="inertia, large strain, smooth walls and points that cross cells, together, to second order in 3D",
    reference="u = A sin(pi X) sin(c pi t), v = A sin(pi Y) sin(c pi t + pi), w = A sin(pi Z) sin(c pi t), A = 0.05 m, "
    "with the body force that makes it exact (after Wallstedt & Guilkey 2008)",
    norm="largest root mean square distance from the exact place over one period, over A",
    mistake="body force 5 % too large",
    measure=measure,
    control=control,
)
