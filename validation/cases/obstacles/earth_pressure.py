"""A smooth wall moves out of the sand, and into it: the force on it is Rankine's active one, and his passive one."""

from typing import Any

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.scenes import advance, shipped_simulation

BAND = 0.05
GRAVITY, DENSITY, HEIGHT, FRICTION = 9.81, 1500.0, 0.3, 0.48
SPEED = 0.02
FROM, UNTIL = 0.2, 0.5  # 4 to 10 mm of way: the wedge slides, and is as high as it was [s]


def limit_force(sign: float, friction: float) -> float:
    """Rankine's force on a smooth wall per width [N/m], active for -1, passive for +1.

    mu(I) slides where tau = mu p in the plane: the sine of the friction angle is mu.
    """
    ratio = (1.0 + sign * friction) / (1.0 - sign * friction)
    return 0.5 * ratio * DENSITY * GRAVITY * HEIGHT**2


def force_on_wall(sign: float, changes: dict[str, Any]) -> tuple[list[float], list[float]]:
    """Ways of the wall [m] and mean forces on it over short intervals [N/m]."""
    simulation = shipped_simulation("retaining_wall", {"obstacle.0.velocity": [sign * SPEED, 0.0], **changes})
    (wall,) = simulation.obstacles.all
    ways, forces = [], []

    def observe(present: Simulation) -> None:
        force, _ = wall.forces.means()
        ways.append(SPEED * present.time)
        forces.append(-float(force[0]))
        wall.forces.reset()

    advance(simulation, UNTIL, observe, intervals=20)
    return ways, forces


def mean_force(found: tuple[list[float], list[float]]) -> float:
    """The mean while the wedge slides [N/m]."""
    sliding = [force for way, force in zip(*found, strict=True) if way > SPEED * FROM * 1.001]
    return sum(sliding) / len(sliding)


def measure(effort: Effort) -> Evidence:
    """Both ways on the shipped cells; in full also on half of them."""
    runs = {sign: force_on_wall(sign, {}) for sign in (-1.0, 1.0)}
    names = {-1.0: "active force", 1.0: "passive force"}
    found = [
        relative_error(names[sign], "N/m", mean_force(run), limit_force(sign, FRICTION), BAND)
        for sign, run in runs.items()
    ]
    if effort is Effort.FULL:
        for sign, name in names.items():
            finer = mean_force(force_on_wall(sign, {"grid.cell_size": 0.00625}))
            found.append(relative_error(f"{name}, half the cell", "N/m", finer, limit_force(sign, FRICTION), BAND))
    curves = tuple(curve(names[sign], *run) for sign, run in runs.items())
    return Evidence(tuple(found), figures=(Figure("Earth pressure", "way of the wall [m]", "force [N/m]", curves),))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Sand whose friction is 20 % smaller."""
    less = {"material.mu_i_lc.static_friction": 0.8 * FRICTION}
    force = mean_force(force_on_wall(-1.0, less))
    return (relative_error("active force", "N/m", force, limit_force(-1.0, FRICTION), BAND),)


CASE = Case(
    name="earth_pressure",
    title="a smooth wall that moves out of sand, and into it",
    proves="the force on an obstacle that moves is that of the limit state which its motion brings about",
    reference="E = (1 -+ sin phi)/(1 +- sin phi) rho g H^2/2 (Rankine 1857), sin phi = mu_s",
    norm="relative error of the mean force over 4 to 10 mm of way",
    mistake="friction of the sand 20 % too small",
    measure=measure,
    control=control,
)
