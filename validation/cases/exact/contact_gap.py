"""Blocks that come down on a floor touch it: no gap is left, and nothing is felt before."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials.registry import get_material
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.kernels.wall_clearance import WallClearance
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Figure, Measurement, curve, scaled_error
from grainlaw.validation.scenes import advance

BAND = 0.05
CELLS = {Effort.QUICK: (0.05, 0.025), Effort.FULL: (0.05, 0.025, 0.0125)}
GRAVITY, DENSITY = 9.81, 1500.0
WIDTH, HEIGHT, DROP = 0.4, 0.2, 0.1
IMPACT = math.sqrt(2.0 * DROP / GRAVITY)
# A drag of this time constant [s] lowers a block at 5 cm/s; then it has some time to come to rest [s].
DRAG, REST = 0.005, 0.3
LAWS: dict[str, dict[str, Any]] = {
    "mu_i_lc": get_material("mu_i_lc").parameter_sets["paper"].parameters._asdict(),
    "linear_elastic": {"bulk_modulus": 392e3, "poisson_ratio": 0.2},
}


class FeltAtOnce(WallClearance):
    """The mistake: a wall that is felt as soon as the shape function of its row reaches a point."""

    def clearances(self) -> NDArray[np.float64]:
        """No clearance anywhere."""
        return np.zeros_like(super().clearances())


class WithoutClearances(Simulation):
    """A simulation with that mistake."""

    def find_active_nodes(self) -> None:
        """Find the active nodes, and forget the points near walls."""
        super().find_active_nodes()
        layers = self.wall_clearance.layers
        self.wall_clearance = FeltAtOnce(layers, self.bodies, self.grid, self.basis, self.periodic_axes, self.threads)


def block(law: str, cell: float, lower: float, kind: type[Simulation], velocity: float = 0.0) -> Simulation:
    """A block whose lower edge is at the height `lower` [m] above a rough floor."""
    left = 0.6 - 0.5 * WIDTH
    content = {
        "gravity": [0.0, -GRAVITY],
        "grid": {"cell_size": cell, "upper": [1.2, 0.6]},
        "boundary": {"bottom": {"kind": "friction", "coefficient": 0.7}},
        "time": {"end": 5.0},
        "material": {law: LAWS[law]},
        "body": [
            {
                "material": law,
                "shape": {"kind": "rectangle", "lower": [left, lower], "upper": [left + WIDTH, lower + HEIGHT]},
                "density": DENSITY,
                "velocity": [0.0, velocity],
            }
        ],
    }
    return kind(Scene.from_dict(content))


def lowest_row(simulation: Simulation) -> float:
    """Mean height of the lowest row of points [cells], a quarter where it touches the floor unstrained."""
    cell = simulation.grid.cell_size
    heights = np.sort(simulation.bodies[0].positions[1])
    return float(heights[: round(2.0 * WIDTH / cell)].mean()) / cell


def gap_when_lowered(law: str, cell: float, kind: type[Simulation] = Simulation) -> float:
    """The gap [cells] of a block that was lowered from two cells above the floor."""
    simulation = block(law, cell, 2.0 * cell, kind)

    def drag(body: Body, time: float) -> NDArray[np.float64]:
        return -body.velocity / DRAG

    simulation.body_force = drag
    advance(simulation, 2.0 * cell / (GRAVITY * DRAG) + REST)
    return lowest_row(simulation) - 0.25


def fallen_at_impact(law: str, cell: float, kind: type[Simulation] = Simulation) -> float:
    """The way [cells] of the centre of a dropped block at the time when a free fall reaches the floor."""
    simulation = block(law, cell, DROP, kind)
    start = float(simulation.bodies[0].positions[1].mean())
    advance(simulation, IMPACT)
    return (start - float(simulation.bodies[0].positions[1].mean())) / cell


def after_impact(law: str, cell: float, lower: float, velocity: float, kind: type[Simulation] = Simulation) -> float:
    """The height of the lowest row [cells] half a second after the impact of a block that may start with it."""
    simulation = block(law, cell, lower, kind, velocity)
    advance(simulation, 0.5 + (IMPACT if lower > 0.0 else 0.0))
    return lowest_row(simulation)


def measurements(law: str, cell: float, kind: type[Simulation] = Simulation) -> Iterable[Measurement]:
    """One law on one cell."""
    where = f"{law}, cell {cell:g} m"
    yield scaled_error(f"{where}: gap after lowering", "cells", gap_when_lowered(law, cell, kind), 0.0, 1.0, BAND)
    way = fallen_at_impact(law, cell, kind)
    yield scaled_error(f"{where}: fallen at the impact", "cells", way, DROP / cell, 1.0, BAND)
    if law == "mu_i_lc":
        dropped = after_impact(law, cell, DROP, 0.0, kind)
        thrown = after_impact(law, cell, 0.0, -GRAVITY * IMPACT)
        yield scaled_error(f"{where}: lowest row after the drop", "cells", dropped, thrown, 1.0, BAND)


def measure(effort: Effort) -> Evidence:
    """Both laws on all cells."""
    cells = CELLS[effort]
    found = {(law, cell): list(measurements(law, cell)) for law in LAWS for cell in cells}
    gaps = {law: [found[law, cell][0].error for cell in cells] for law in LAWS}
    orders = tuple(
        Convergence(f"{law}: gap after lowering [m]", "cell [m]", cells, tuple(np.multiply(gaps[law], cells)))
        for law in LAWS
    )
    curves = [curve(law, cells, gaps[law]) for law in LAWS]
    curves.append(curve("band", cells, [BAND for _ in cells], "reference"))
    figure = Figure("Gap after lowering", "cell [m]", "gap [cells]", tuple(curves), "xy")
    return Evidence(tuple(m for one in found.values() for m in one), convergence=orders, figures=(figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Both laws on the coarsest cell, with walls that are felt at once."""
    return tuple(m for law in LAWS for m in measurements(law, CELLS[effort][0], WithoutClearances))


CASE = Case(
    name="contact_gap",
    title="blocks lowered and dropped on a floor",
    proves="contact begins where material meets the wall, neither a part of a cell before nor after",
    reference="no gap; free fall down to the floor; a dropped block ends like one thrown from the floor at sqrt(2 g d)",
    norm="difference of lengths in cells",
    mistake="a wall that is felt as soon as the shape function of its row reaches a point",
    measure=measure,
    control=control,
)
