"""A column under its own weight between smooth walls: statics decides the vertical stress, whatever the law."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.mpm_core.space import PLANE_STRAIN, Space
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.scenes import advance, block, in_order_of_generation, simulation_of

BAND, SETTLEMENT_BAND = 5e-3, 1e-3
HEIGHT, DENSITY, GRAVITY = 1.0, 1500.0, 9.81
CELLS = 40
WEIGHT = DENSITY * GRAVITY * HEIGHT
LAWS: dict[str, dict[str, float]] = {
    "linear_elastic": {"bulk_modulus": 1e6, "poisson_ratio": 0.2},
    "mu_i_lc": {
        "static_friction": 0.69,
        "dynamic_friction": 1.25,
        "inertial_number_constant": 0.279,
        "bulk_modulus": 392e3,
        "poisson_ratio": 0.2,
        "grain_density": 2450.0,
        "grain_diameter": 0.005,
    },
    "modified_cam_clay": {
        "critical_state_ratio": 1.2,
        "compression_index": 0.04,
        "swelling_index": 0.008,
        "poisson_ratio": 0.2,
        "overconsolidation_ratio": 1.0,
        "grain_density": 2450.0,
    },
}
DURATION = {Effort.QUICK: 0.5, Effort.FULL: 10.0}


@dataclass
class Observation:
    """Largest errors over a run, over the weight of the column or its height, and the last stresses over depth."""

    stress: float = 0.0
    settlement: float = 0.0
    depth: Any = None
    last: Any = None


def scene(law: str, gravity: float, space: Space) -> dict[str, Any]:
    """A column, 4 cells wide and 40 high, that starts in equilibrium with its weight."""
    size, across = HEIGHT / CELLS, space.axes - 1
    return {
        "space": space.name,
        "gravity": [*[0.0] * across, -gravity],
        "grid": {"cell_size": size, "upper": [*[4.0 * size] * across, 1.2 * HEIGHT]},
        "time": {"end": 10.0},
        "material": {law: LAWS[law]},
        "body": [
            {
                "material": law,
                "shape": block([0.0] * space.axes, [*[4.0 * size] * across, HEIGHT]),
                "density": DENSITY,
                "initial_stress": {"kind": "geostatic"},
            }
        ],
    }


def observed(law: str, duration: float, gravity: float = GRAVITY, space: Space = PLANE_STRAIN) -> Observation:
    """A column over time: the stress of each point against the weight of what was above it at the start."""
    simulation = simulation_of(scene(law, gravity, space))
    body, up = simulation.bodies[0], space.up
    start = in_order_of_generation(body, body.positions)
    result = Observation(depth=HEIGHT - start[up])

    def observe(present: Simulation) -> None:
        result.last = in_order_of_generation(body, body.stress[up])
        errors = np.abs(result.last + DENSITY * GRAVITY * result.depth) / WEIGHT
        result.stress = max(result.stress, float(errors.max()))
        moved = np.abs(in_order_of_generation(body, body.positions) - start) / HEIGHT
        result.settlement = max(result.settlement, float(moved.max()))

    advance(simulation, duration, observe, intervals=50)
    return result


def measurements(law: str, result: Observation, label: str = "") -> tuple[Measurement, ...]:
    """The largest errors of one law."""
    return (
        upper_bound(f"{law}: largest error of the vertical stress{label}", "1", result.stress, BAND),
        upper_bound(f"{law}: largest displacement{label}", "1", result.settlement, SETTLEMENT_BAND),
    )


def measure(effort: Effort) -> Evidence:
    """The three kinds of law."""
    results = {law: observed(law, DURATION[effort]) for law in LAWS}
    curves = [curve("-rho g depth", [0.0, 1e-3 * WEIGHT], [HEIGHT, 0.0], "reference")]
    for law, result in results.items():
        curves.append(curve(law, -1e-3 * result.last[::8], HEIGHT - result.depth[::8]))
    figure = Figure("Vertical stress at the end", "-sigma_yy [kPa]", "height [m]", tuple(curves))
    found = [measurement for law, result in results.items() for measurement in measurements(law, result)]
    return Evidence(tuple(found), figures=(figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A column that weighs 2 % less."""
    return measurements("linear_elastic", observed("linear_elastic", 0.1, 0.98 * GRAVITY))


CASE = Case(
    name="self_weight_column",
    title="column under its own weight, 40 cells",
    proves="equilibrium of stress, gravity and walls, up to the free surface and down to the floor, and that it lasts",
    reference="sigma_yy = -rho_0 g (H - Y) with the initial height Y of a point, exact for any law",
    norm="largest error over points and times, over rho g H; largest displacement over H",
    mistake="gravity 2 % too small",
    measure=measure,
    control=control,
)
