"""The paper's column as the benchmarks use it: at rest at the start, or set in motion so that every point yields."""

from grainlaw.mpm_core.parallel.threads import use_threads
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.cases.collapses.column import collapse

# The rate [1/s] at which the column spreads and sinks: about the mean of a collapse that takes half a second.
SPREADING_RATE = 2.0
COLUMN_AREA = 0.3 * 0.9
POINTS_PER_CELL = 4
# A time [s] far beyond one step.
AHEAD = 1.0


def cell_size_for(points: float) -> float:
    """A cell size [m] that divides the domain and gives about this many points."""
    cells_per_metre = (points / POINTS_PER_CELL / COLUMN_AREA) ** 0.5
    return 1.0 / (20 * max(1, round(cells_per_metre / 20)))


def moving_column(
    material: str, cell_size: float, threads: int = 1, domain_factor: int = 1, precision: str = "double"
) -> Simulation:
    """The column with a velocity field that stretches and lowers it without change of volume.

    `domain_factor` enlarges the domain along both axes; the column stays where it is on the grid.
    """
    upper = [3.2 * domain_factor, 1.0 * domain_factor]
    simulation = collapse(material, cell_size, {"grid.upper": upper, "precision": precision})
    simulation.threads = threads
    set_in_motion(simulation, (SPREADING_RATE, -SPREADING_RATE))
    return simulation


def set_in_motion(simulation: Simulation, rates: tuple[float, ...]) -> None:
    """Stretch the body along each axis at a rate [1/s]: horizontally about its middle, vertically from the floor."""
    body = simulation.bodies[0]
    for axis, rate in enumerate(rates):
        middle = 0.0 if axis == simulation.space.up else body.positions[axis].mean()
        body.velocity[axis] = rate * (body.positions[axis] - middle)
        body.velocity_gradient[axis, axis] = body.affine[axis, axis] = rate


def make_steps(simulation: Simulation, count: int) -> None:
    """Take steps on the simulation's own number of threads."""
    use_threads(simulation.threads)
    for _ in range(count):
        dt, _ = simulation.next_step(simulation.time + AHEAD)
        simulation.step(dt)
