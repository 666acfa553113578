"""A heap below its angle of repose stays as it is, whatever the law."""

from typing import Any

import numpy as np

from grainlaw.materials.registry import get_material
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error, upper_bound
from grainlaw.validation.scenes import advance, shipped_simulation

SETTLEMENT_BAND, STRESS_BAND = 1e-3, 1e-2
CELL = {Effort.QUICK: 0.025, Effort.FULL: 0.0125}
# The heap starts with the weight of each column as its pressure, which is no equilibrium, and first adjusts to it [s].
ADJUSTED = 0.5
WATCH = {Effort.QUICK: 1.0, Effort.FULL: 10.0}
LAWS = ("drucker_prager", "mu_i_lc", "mu_i_elastoplastic", "mu_i_phi_i", "mu_i_state", "modified_cam_clay", "mu_i_mcc")
# tan of the slope is 1/3; friction of the control.
SLIPPERY = {"static_friction": 0.2, "dynamic_friction": 0.4}


def heap(law: str, cell_size: float, changes: dict[str, float] | None = None) -> Simulation:
    """The shipped heap of another law, with the law's set `paper`."""
    parameters = get_material(law).parameter_sets["paper"].parameters._asdict()
    return shipped_simulation(
        "heap",
        {
            "grid.cell_size": cell_size,
            "material": {law: parameters | (changes or {})},
            "body.0.material": law,
            "output.fields": [],
        },
    )


def height(simulation: Simulation) -> float:
    """The height of a triangle with this centre of mass [m]; it feels every point, not one at the top."""
    return 3.0 * float(simulation.bodies[0].positions[1].mean())


def stress(simulation: Simulation) -> tuple[float, float]:
    """Integral of -sigma_yy over the heap, and what statics asks for: the weight times the height of its centre [J/m].

    Multiplying the equilibrium of a body on a floor at y = 0 by y gives int -sigma_yy dV = m g y_c, for any law.
    """
    body = simulation.bodies[0]
    volumes = body.volume
    weight = -simulation.scene.gravity[1] * body.point_mass
    return float((-volumes * body.stress[1]).sum()), weight * float(body.positions[1].sum())


def watched(law: str, effort: Effort, changes: dict[str, float] | None = None) -> tuple[list[float], list[float], Any]:
    """Times [s], heights [m] and the integrals of the stress from the end of the adjustment on."""
    simulation = heap(law, CELL[effort], changes)
    advance(simulation, ADJUSTED)
    times, heights = [simulation.time], [height(simulation)]
    integrals = [stress(simulation)]

    def observe(present: Simulation) -> None:
        times.append(present.time)
        heights.append(height(present))
        integrals.append(stress(present))

    advance(simulation, ADJUSTED + WATCH[effort], observe, intervals=20)
    return times, heights, np.array(integrals)


def measurements(law: str, heights: list[float], integrals: Any) -> tuple[Measurement, ...]:
    """Loss of height over height, and the mean vertical stress against statics, averaged over the watch."""
    measured, exact = integrals.mean(axis=0)
    return (
        upper_bound(f"{law}: settlement over height", "1", (heights[0] - heights[-1]) / heights[0], SETTLEMENT_BAND),
        relative_error(f"{law}: integral of -sigma_yy", "J/m", measured, exact, STRESS_BAND),
    )


def measure(effort: Effort) -> Evidence:
    """Every granular law."""
    found: list[Measurement] = []
    curves = []
    for law in LAWS:
        times, heights, integrals = watched(law, effort)
        found += measurements(law, heights, integrals)
        curves.append(curve(law, times, [1.0 - value / heights[0] for value in heights]))
    figure = Figure("Settlement of the heap", "time [s]", "settlement over height [1]", tuple(curves))
    return Evidence(tuple(found), figures=(figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A heap steeper than its angle of repose."""
    _, heights, integrals = watched("mu_i_lc", Effort.QUICK, SLIPPERY)
    return measurements("mu_i_lc, slippery", heights, integrals)


CASE = Case(
    name="heap_at_rest",
    title="heap below its angle of repose",
    proves="a slope that friction can hold is held, without creep, and its stress carries its weight",
    reference="no settlement over 10 s once it has adjusted; int -sigma_yy dV = m g y_c, exact for any law at rest",
    norm="loss of three times the centre's height over that height; relative error of the integral",
    mistake="friction of 0.2, less than the slope of 1/3",
    measure=measure,
    control=control,
)
