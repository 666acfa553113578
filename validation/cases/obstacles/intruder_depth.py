"""A ball falls into a bed of glass beads and stops at a depth that grows as the cube root of its drop."""

import math
from typing import Any

import numpy as np

from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error, scaled_error
from grainlaw.validation.scenes import simulation_of

GRAVITY, DIAMETER, BALL_DENSITY, BED_DENSITY = 9.81, 0.0254, 2500.0, 1500.0
# Glass beads: Jop, Forterre & Pouliquen 2006 (Nature 441, 727).
GLASS = {
    "static_friction": 0.38,
    "dynamic_friction": 0.64,
    "inertial_number_constant": 0.279,
    "bulk_modulus": 1e6,
    "poisson_ratio": 0.2,
    "grain_density": 2500.0,
    "grain_diameter": 0.0003,
}
FRICTIONS = ("static_friction", "dynamic_friction")
LESS_FRICTION = 0.6
BED = 0.1  # radius and depth [m]
FALLS = (0.03, 0.06, 0.12, 0.24, 0.48)  # above the bed [m]
CELLS = {Effort.QUICK: 0.0025, Effort.FULL: 0.00125}  # [m]
HEAVY = 7900.0  # a ball of steel [kg/m3]
EXPONENT_BAND, DEPTH_BAND = 0.1, 0.3
LOOK, LONGEST = 0.0025, 0.4  # [s]


def expected_depth(drop: float) -> float:
    """Of the ball [m], after a drop [m] that ends at its depth (Uehara, Ambroso, Ojha & Durian 2003)."""
    friction = GLASS["static_friction"]
    return 0.14 / friction * math.sqrt(BALL_DENSITY / BED_DENSITY) * DIAMETER ** (2.0 / 3.0) * float(np.cbrt(drop))


def scene(fall: float, cell: float, ball_density: float, friction: float) -> dict[str, Any]:
    """The bed around its axis, and the ball that has fallen and is about to touch it."""
    center = BED + 0.5 * DIAMETER
    return {
        "space": "axisymmetric",
        "gravity": [0.0, -GRAVITY],
        "grid": {"cell_size": cell, "upper": [BED, 2.0 * BED]},
        "time": {"end": LONGEST},
        "boundary": {
            side: {"kind": "friction", "coefficient": GLASS["static_friction"]} for side in ("bottom", "right")
        },
        "material": {"mu_i_lc": GLASS | {name: friction * GLASS[name] for name in FRICTIONS}},
        "body": [
            {
                "material": "mu_i_lc",
                "density": BED_DENSITY,
                "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [BED, BED]},
                "initial_stress": {"kind": "geostatic", "horizontal_ratio": 0.6},
            }
        ],
        "obstacle": [
            {
                "name": "ball",
                "friction": 0.3,
                "shape": {"kind": "disc", "center": [0.0, center], "radius": 0.5 * DIAMETER},
                "free": {"density": ball_density, "velocity": [0.0, -math.sqrt(2.0 * GRAVITY * fall)]},
            }
        ],
    }


def depth(fall: float, cell: float, ball_density: float = BALL_DENSITY, friction: float = 1.0) -> float:
    """How deep the ball goes before it stops or turns [m]; NaN if it does neither."""
    simulation = simulation_of(scene(fall, cell, ball_density, friction))
    motion = simulation.obstacles.all[0].motion
    start = lowest = float(motion.pose.position[1])
    while simulation.time < LONGEST:
        simulation.advance_to(simulation.time + LOOK)
        now = float(motion.pose.position[1])
        if now >= lowest:
            return start - lowest
        lowest = now
    return math.nan


def depths(cell: float, ball_density: float = BALL_DENSITY, friction: float = 1.0) -> dict[float, float]:
    """Depth over drop, both [m], of all falls; a drop is a fall and the depth."""
    found = {fall: depth(fall, cell, ball_density, friction) for fall in FALLS}
    return {fall + deep: deep for fall, deep in found.items()}


def exponent(found: dict[float, float]) -> Measurement:
    """Of the depth over the drop."""
    drops, deep = map(np.log, (list(found), list(found.values())))
    return scaled_error("exponent of the drop", "1", np.polyfit(drops, deep, 1)[0], 1.0 / 3.0, 1.0, EXPONENT_BAND)


def mean_depth(found: dict[float, float]) -> Measurement:
    """Over that expected, in the geometric mean."""
    ratio = math.exp(np.mean([math.log(deep / expected_depth(drop)) for drop, deep in found.items()]))
    return relative_error("depth over that of experiments", "1", ratio, 1.0, DEPTH_BAND)


def of_density(light: dict[float, float], heavy: dict[float, float]) -> Measurement:
    """The exponent of the ball's density, at the drop that is the middle one of the light ball."""
    drop = sorted(light)[len(light) // 2]
    deep_heavy = math.exp(np.interp(math.log(drop), np.log(list(heavy)), np.log(list(heavy.values()))))
    power = math.log(deep_heavy / light[drop]) / math.log(HEAVY / BALL_DENSITY)
    return scaled_error("exponent of the ball's density", "1", power, 0.5, 1.0, EXPONENT_BAND)


def measure(effort: Effort) -> Evidence:
    """Five drops of a light ball; in full on half of the cells, and of a heavy ball."""
    light = depths(CELLS[effort])
    found, curves = [exponent(light), mean_depth(light)], [curve("light ball", list(light), list(light.values()))]
    if effort is Effort.FULL:
        heavy = depths(CELLS[effort], HEAVY)
        found.append(of_density(light, heavy))
        curves.append(curve("heavy ball", list(heavy), list(heavy.values())))
    curves.append(curve("experiments, light ball", list(light), [expected_depth(drop) for drop in light], "reference"))
    return Evidence(tuple(found), figures=(Figure("Depth of a ball", "drop [m]", "depth [m]", tuple(curves), "xy"),))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The depth in beads with too little friction."""
    return (mean_depth(depths(CELLS[Effort.QUICK], friction=LESS_FRICTION)),)


CASE = Case(
    name="intruder_depth",
    title="depth at which a ball stops that falls into a bed of glass beads, in axisymmetry",
    proves="a free obstacle is stopped by sand as balls are in experiments",
    reference="d = 0.14/mu (rho_b/rho_g)^(1/2) D^(2/3) H^(1/3) (Uehara, Ambroso, Ojha & Durian 2003, Phys. Rev. Lett. "
    "90, 194301), H the drop down to d, mu the law's static friction",
    norm="difference of the exponents; mean of the depth over that of the formula",
    mistake="friction of the law 40 % too low",
    measure=measure,
    control=control,
)
