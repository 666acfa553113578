"""A disc that expands in proportion to the radius, and one under uniform pressure: what the axis does to material."""

from typing import Any

import numpy as np

from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.grid import COMPONENTS, GHOSTS
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, upper_bound
from grainlaw.validation.scenes import simulation_of

RATE_BAND, DENSITY_BAND, FORCE_BAND = 1e-12, 1e-6, 1e-12
# What the sum over points misses of the integral on the first ring of nodes, where the weight r has a kink.
FIRST_RING_BAND = 0.02
CELLS, HEIGHT_IN_CELLS = 8, 4
DENSITY, PRESSURE = 1e3, 1e3
# 1/s, and steps of a thousandth of its inverse: the midpoint rule for the density is off by their square.
RATE, STEP, STEPS = 1.0, 1e-3, 100
POINTS_PER_CELL = {Effort.QUICK: (4,), Effort.FULL: (4, 9, 16)}


def scene(points_per_cell: int, stress: dict[str, Any], room: float) -> dict[str, Any]:
    """A disc of radius 1 m around the axis, between smooth plates; `room` [m] from a smooth wall."""
    size = 1.0 / CELLS
    height = HEIGHT_IN_CELLS * size
    return {
        "space": "axisymmetric",
        "gravity": [0.0, 0.0],
        "grid": {"cell_size": size, "upper": [1.0 + room, height]},
        "time": {"end": 1.0},
        "material": {"linear_elastic": {"bulk_modulus": 1e5, "poisson_ratio": 0.3}},
        "body": [
            {
                "material": "linear_elastic",
                "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [1.0, height]},
                "density": DENSITY,
                "points_per_cell": points_per_cell,
                "initial_stress": stress,
            }
        ],
    }


def expand(points_per_cell: int, withhold_hoop: bool = False) -> tuple[Measurement, ...]:
    """Lead a disc through r = r_0 (1 + a t), step by step with the rate of the middle of the step."""
    simulation = simulation_of(scene(points_per_cell, {"kind": "none"}, room=0.5))
    body = simulation.bodies[0]
    start = body.positions.copy()
    if withhold_hoop:
        _withhold_hoop(body)
    along_radius = around_axis = 0.0
    for number in range(STEPS):
        rate = RATE / (1.0 + RATE * STEP * (number + 0.5))
        _place(body, start, 1.0 + RATE * STEP * number, rate)
        simulation.step(STEP)
        around = body.points[body.layout.hoop_gradient]
        along_radius = max(along_radius, float(np.abs(body.velocity_gradient[0, 0] / rate - 1.0).max()))
        around_axis = max(around_axis, float(np.abs(around / rate - 1.0).max()))
    exact = DENSITY / (1.0 + RATE * STEP * STEPS) ** 2
    label = f", {points_per_cell} points per cell"
    return (
        upper_bound(f"L_rr/a - 1{label}", "1", along_radius, RATE_BAND),
        upper_bound(f"L_theta/a - 1{label}", "1", around_axis, RATE_BAND),
        upper_bound(f"rho/rho_exact - 1{label}", "1", np.abs(body.density / exact - 1.0).max(), DENSITY_BAND),
    )


def _place(body: Body, start: np.ndarray, stretch: float, rate: float) -> None:
    """Put the points where the expansion has them, with its velocity and gradient, and without stress."""
    radius, height = start[:, body.ids]
    body.positions = np.array([radius * stretch, height])
    body.velocity = np.array([rate * radius * stretch, 0.0 * height])
    body.affine = np.array([[[rate], [0.0]], [[0.0], [0.0]]])
    body.stress = 0.0


def _withhold_hoop(body: Body) -> None:
    """Show the stress pass no stretch around the axis."""
    update = body.update_stress

    def without_hoop(dt: float, coupled_time: float = 0.0, threads: int = 1) -> None:
        body.points[body.layout.hoop_gradient] = 0.0
        update(dt, coupled_time, threads)

    body.update_stress = without_hoop  # type: ignore[method-assign]


def forces(points_per_cell: int, hoop_stress: float = -PRESSURE) -> tuple[Measurement, ...]:
    """Accelerations of rings of nodes inside a confined disc, up to two cells from its wall, over p/(rho h)."""
    simulation = simulation_of(scene(points_per_cell, {"kind": "uniform", "pressure": PRESSURE}, room=0.0))
    simulation.bodies[0].stress[2] = hoop_stress
    simulation.step(STEP)
    grid = simulation.grid
    nodes = grid.nodes.reshape(*grid.shape, COMPONENTS)[GHOSTS + 1 : GHOSTS + CELLS - 1, GHOSTS + HEIGHT_IN_CELLS // 2]
    # the first step acts on the velocities of the middle of the step
    acceleration = np.abs(nodes[:, grid.components.momentum]) / (0.5 * STEP)
    first, *others = (acceleration / (PRESSURE / (DENSITY * grid.cell_size))).tolist()
    label = f", {points_per_cell} points per cell"
    return (
        upper_bound(f"force on the first ring of nodes{label}", "1", first, FIRST_RING_BAND),
        upper_bound(f"largest force on the rings beyond{label}", "1", max(others), FORCE_BAND),
    )


def measure(effort: Effort) -> Evidence:
    """Discs of several numbers of points per cell."""
    counts = POINTS_PER_CELL[effort]
    return Evidence(tuple(found for count in counts for found in (*expand(count), *forces(count))))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A disc of which each part takes no notice of what goes on around the axis."""
    return *expand(4, withhold_hoop=True), *forces(4, hoop_stress=0.0)


CASE = Case(
    name="radial_expansion",
    title="radial expansion and uniform pressure next to the axis",
    proves="stretch and force around the axis, also in the cells next to it",
    reference="v_r = a r: L_rr = L_theta = a and rho = rho_0/(1 + a t)^2; no force inside of a uniform pressure",
    norm="largest error over the points and steps, over a; acceleration of a node over p/(rho h)",
    mistake="no stretch and no stress around the axis",
    measure=measure,
    control=control,
)
