"""What happens to points at the edge of the domain: walls hold them, and a point beyond one stops the run."""

from typing import Any

from grainlaw.materials import InputError, SimulationError
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, upper_bound
from grainlaw.validation.scenes import PAPER, advance, one_body, simulation_of

SPEED, END = 5.0, 0.3
CELL = {Effort.QUICK: 0.05, Effort.FULL: 0.025}
DIRECTIONS = {"left": (-1.0, 0.0), "right": (1.0, 0.0), "bottom": (0.0, -1.0), "top": (0.0, 1.0), "corner": (0.7, 0.7)}
BEYOND = 1.02


def scene(cell_size: float, kind: str, direction: tuple[float, float]) -> dict[str, Any]:
    """A block of mu(I)-LC thrown across a closed box."""
    wall: dict[str, Any] = {"kind": kind}
    if kind == "friction":
        wall["coefficient"] = 0.5
    thrown = one_body(
        PAPER["mu(I)-LC"],
        {"kind": "rectangle", "lower": [0.4, 0.4], "upper": [0.6, 0.6]},
        cell_size,
        [1.0, 1.0],
        velocity=[SPEED * direction[0], SPEED * direction[1]],
        initial_stress={"kind": "uniform", "pressure": 10.0},
    )
    return {**thrown, "boundary": dict.fromkeys(("left", "right", "bottom", "top"), wall)}


def points_beyond(simulation: Simulation) -> int:
    """Points outside the domain."""
    places = simulation.bodies[0].positions
    return int(((places < 0.0) | (places > 1.0)).any(axis=0).sum())


def thrown(kind: str, side: str, effort: Effort) -> Measurement:
    """Points that get past a wall at 5 m/s."""
    simulation = simulation_of(scene(CELL[effort], kind, DIRECTIONS[side]))
    advance(simulation, END)
    return upper_bound(f"points beyond: {kind}, {side}", "1", points_beyond(simulation), 0.0)


def stops_with_its_place(simulation: Simulation) -> Measurement:
    """A point that a program puts beyond the wall stops the run with a message that names it; 0 if it does."""
    try:
        simulation.step(1e-5)
    except SimulationError as error:
        named = "has left the domain" in str(error) and f"({BEYOND:g}" in str(error)
        return upper_bound("a point beyond a wall goes unnamed", "1", float(not named), 0.0)
    return upper_bound("a point beyond a wall goes unnamed", "1", 1.0, 0.0)


def _with_a_point_beyond() -> Simulation:
    simulation = simulation_of(scene(CELL[Effort.QUICK], "free_slip", (0.0, 0.0)))
    simulation.bodies[0].positions[0, 0] = BEYOND
    return simulation


def body_outside_is_refused() -> Measurement:
    """A scene whose body reaches out of the domain is refused; 0 if it is."""
    content = scene(CELL[Effort.QUICK], "free_slip", (0.0, 0.0))
    content["body"][0]["shape"]["upper"] = [1.2, 0.6]
    try:
        simulation_of(content)
    except InputError:
        return upper_bound("a body outside is accepted", "1", 0.0, 0.0)
    return upper_bound("a body outside is accepted", "1", 1.0, 0.0)


def measure(effort: Effort) -> Evidence:
    """All walls and directions, and the two refusals."""
    held = tuple(thrown(kind, side, effort) for kind in ("free_slip", "no_slip", "friction") for side in DIRECTIONS)
    policy = "policy: walls hold the material, a scene outside is refused, a point beyond a wall stops the run"
    return Evidence((*held, stops_with_its_place(_with_a_point_beyond()), body_outside_is_refused()), notes=(policy,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The point beyond the wall with the check switched off."""
    simulation = _with_a_point_beyond()
    simulation._refuse_lost_points = lambda report: None  # type: ignore[method-assign]
    return (stops_with_its_place(simulation),)


CASE = Case(
    name="leaving_the_domain",
    title="points at the edge of the domain",
    proves="no point is lost in silence",
    reference="walls hold what is thrown at them at 5 m/s; a point beyond a wall stops the run and is named",
    norm="number of points beyond the walls",
    mistake="the check of the points' places switched off",
    measure=measure,
    control=control,
)
