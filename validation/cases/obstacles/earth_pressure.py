"""A smooth wall moves out of the sand, and into it: the force on it is Rankine's active one, and his passive one.

The law keeps its volume where it slides. Such sand does not follow its friction: on a band whose faces slide along one
another without moving apart tau/sigma is sin phi, not tan phi (Davis 1968). When the limit is reached the whole wedge
yields, and the force is Rankine's; once it slides on bands, it lies between Rankine's and that of the friction angle
atan(sin phi), the nearer to the latter the thinner the bands are, as cells let them be.
"""

import math
from typing import Any

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error, upper_bound
from grainlaw.validation.scenes import advance, shipped_simulation

BAND = 0.05
GRAVITY, DENSITY, HEIGHT, FRICTION = 9.81, 1500.0, 0.3, 0.48
SPEED = 0.02
REACHED = (0.1, 0.2)  # 2.5 to 4 mm of way: the passive limit is reached, and no bands have formed yet [s]
SLIDING = (0.2, 0.5)  # to 10 mm of way: the wedge slides, and is as high as it was [s]


def limit_force(sign: float, sine: float) -> float:
    """Rankine's force on a smooth wall per width [N/m], active for -1, passive for +1.

    mu(I) slides where tau = mu p in the plane: the sine is mu.
    """
    ratio = (1.0 + sign * sine) / (1.0 - sign * sine)
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

    advance(simulation, SLIDING[1], observe, intervals=20)
    return ways, forces


def mean_force(found: tuple[list[float], list[float]], times: tuple[float, float]) -> float:
    """The mean between two times [N/m]."""
    start, end = (SPEED * time for time in times)
    chosen = [force for way, force in zip(*found, strict=True) if 1.001 * start < way < 1.001 * end]
    return sum(chosen) / len(chosen)


def on_bands(sign: float, sliding: float) -> float:
    """How far a force lies outside of the limits of a wedge that slides on bands, as a share of Rankine's."""
    rankine = limit_force(sign, FRICTION)
    davis = limit_force(sign, math.sin(math.atan(FRICTION)))
    least, most = sorted((rankine, davis))
    return max(least - sliding, sliding - most, 0.0) / rankine


def measured(label: str, sign: float, run: tuple[list[float], list[float]]) -> list[Measurement]:
    """The active force, which fluctuates, while the wedge slides; the passive one also when it is reached."""
    sliding, rankine = mean_force(run, SLIDING), limit_force(sign, FRICTION)
    if sign < 0.0:
        return [relative_error(label, "N/m", sliding, rankine, BAND)]
    return [
        relative_error(f"{label} when it is reached", "N/m", mean_force(run, REACHED), rankine, BAND),
        upper_bound(f"{label} while it slides, outside of the limits", "1", on_bands(sign, sliding), BAND),
    ]


def measure(effort: Effort) -> Evidence:
    """Both ways on the shipped cells; in full also on half of them."""
    found: list[Measurement] = []
    curves = []
    for cell in (0.0125, 0.00625) if effort is Effort.FULL else (0.0125,):
        for sign, name in ((-1.0, "active force"), (1.0, "passive force")):
            run, label = force_on_wall(sign, {"grid.cell_size": cell}), f"{name}, {1e3 * cell:g} mm"
            found += measured(label, sign, run)
            curves.append(curve(label, *run))
    return Evidence(
        tuple(found), figures=(Figure("Earth pressure", "way of the wall [m]", "force [N/m]", tuple(curves)),)
    )


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Sand whose friction is 20 % smaller."""
    less = {"material.mu_i_lc.static_friction": 0.8 * FRICTION}
    return tuple(measured("active force", -1.0, force_on_wall(-1.0, less)))


CASE = Case(
    name="earth_pressure",
    title="a smooth wall that moves out of sand, and into it",
    proves="the force on an obstacle that moves is that of the limit state which its motion brings about",
    reference="E = (1 -+ sin phi)/(1 +- sin phi) rho g H^2/2 (Rankine 1857), sin phi = mu_s",
    norm="relative error of the mean force over 4 to 10 mm of way; of the passive one over 2.5 to 4 mm, then its "
    "distance from the limits for sliding bands",
    mistake="friction of the sand 20 % too small",
    measure=measure,
    control=control,
)
