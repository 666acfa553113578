"""Collapse of a pile of aluminium bars, the two-dimensional experiment of Bui et al. (2008)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.scenes import advance, in_order_of_generation, shipped_simulation

Array = NDArray[np.floating[Any]]

TOE_BAND = 5e-2
CELL = {Effort.QUICK: 0.005, Effort.FULL: 0.0025}
END = 1.0
# Surface of the deposit, and where the line between bars that moved and bars that did not meets the base [m].
SURFACE = np.array(
    [
        (0.0, 0.0992),
        (0.040, 0.0959),
        (0.080, 0.0844),
        (0.120, 0.0722),
        (0.160, 0.0616),
        (0.200, 0.0474),
        (0.241, 0.0348),
        (0.282, 0.0265),
        (0.322, 0.0189),
        (0.362, 0.0109),
        (0.402, 0.0037),
        (0.442, 0.0015),
    ]
)
FAILURE_AT_BASE = 0.179
# A bar counts as moved once it is displaced by its own diameter.
MOVED = 0.0015
SMOOTHER = {"material.mu_i_lc.static_friction": 0.25, "material.mu_i_lc.dynamic_friction": 0.25}


def collapsed(effort: Effort, changes: dict[str, Any] | None = None) -> tuple[Simulation, Array]:
    """The deposit, and the displacement of each point in the order of generation, shape (n,) [m]."""
    changes = {"grid.cell_size": CELL[effort], "output.fields": [], **(changes or {})}
    simulation = shipped_simulation("aluminium_bars", changes)
    body = simulation.bodies[0]
    start = body.positions.copy()
    advance(simulation, END)
    end = in_order_of_generation(body, body.positions)
    return simulation, np.hypot(*(end - start))


def surface(simulation: Simulation) -> tuple[Array, Array]:
    """Middles of columns one cell wide [m], and the height that the volume of their points fills [m]."""
    body, cell = simulation.bodies[0], simulation.grid.cell_size
    columns = (body.positions[0] / cell).astype(int)
    volume = np.bincount(columns, body.volume, simulation.grid.cells[0])
    return cell * (np.arange(len(volume)) + 0.5), volume / cell


def toe(x: Array, height: Array) -> float:
    """Where the surface comes down to the height of the last bar that was measured [m]."""
    above = int(np.nonzero(height > SURFACE[-1, 1])[0].max())
    share = (height[above] - SURFACE[-1, 1]) / (height[above] - height[above + 1])
    return float(x[above] + share * (x[above + 1] - x[above]))


def area_between(x: Array, height: Array) -> float:
    """Area between the two surfaces over the area of the pile."""
    measured = np.interp(x, SURFACE[:, 0], SURFACE[:, 1], right=0.0)
    return float(np.abs(height - measured).sum() / measured.sum())


def failure_at_base(simulation: Simulation, moved: Array) -> float:
    """The place at the start of the first point of the lowest row that has moved [m]."""
    cell = simulation.grid.cell_size
    start = shipped_simulation("aluminium_bars", {"grid.cell_size": cell, "output.fields": []}).bodies[0].positions
    lowest = start[1] < 0.5 * cell
    return float(start[0][lowest & (moved > MOVED)].min())


def toe_measurement(x: Array, height: Array) -> Measurement:
    """The toe against the experiment."""
    return relative_error("toe", "m", toe(x, height), float(SURFACE[-1, 0]), TOE_BAND)


def measure(effort: Effort) -> Evidence:
    """The shipped scene."""
    simulation, moved = collapsed(effort)
    x, height = surface(simulation)
    failure = failure_at_base(simulation, moved)
    figure = Figure(
        "Deposit of aluminium bars",
        "x [m]",
        "height [m]",
        (
            curve("measured by Bui et al. (2008)", SURFACE[:, 0], SURFACE[:, 1], "reference"),
            curve("mu(I)-LC, constant friction", x[height > 0.0], height[height > 0.0]),
        ),
    )
    notes = (
        f"area between the surfaces over that of the pile: {area_between(x, height):.3f}",
        f"failure line at the base: x = {failure:.3f} m, measured {FAILURE_AT_BASE:g} m",
        f"height at the wall: {height[0]:.4f} m, measured {SURFACE[0, 1]:g} m",
    )
    return Evidence((toe_measurement(x, height),), figures=(figure,), notes=notes)


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Smoother bars."""
    return (toe_measurement(*surface(collapsed(Effort.QUICK, SMOOTHER)[0])),)


CASE = Case(
    name="aluminium_bars",
    title="collapse of aluminium bars",
    proves="a frictional material of measured strength comes to rest where the experiment does",
    reference="surface and failure line measured by Bui et al. (2008): 0.2 m x 0.1 m, 2650 kg/m3, 19.8 degrees",
    norm="relative error of the toe; area between the surfaces stated",
    mistake="friction 0.25 instead of sin(19.8 degrees) = 0.339",
    measure=measure,
    control=control,
)
