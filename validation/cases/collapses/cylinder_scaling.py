"""Runout and height of cylinders from half as high as their radius to eight times, against experiments and grains."""

import math
from typing import Any, NamedTuple

import numpy as np

from grainlaw.mpm_core.output.observables import shape_of
from grainlaw.validation.case import (
    Case,
    Curve,
    Effort,
    Evidence,
    Figure,
    Measurement,
    curve,
    relative_error,
    scaled_error,
)
from grainlaw.validation.cases.collapses.scaling import END, PowerLaw, Scaling, fitted, listed, outside, runout_of
from grainlaw.validation.reference.reference_set import ReferenceSet, read_reference_set
from grainlaw.validation.scenes import advance, shipped_simulation

SCENE, LAW = "cylinder_collapse_axisymmetric", "mu_i_lc"
# As in our own runs of grains: 15 diameters.
RADIUS = 0.225
# The floor counts as covered where a tenth of it is, by grains of the diameter d: a depth of 2/3 d/10 of solid.
COVERED = 0.1

ASPECT_RATIOS = {Effort.QUICK: (0.5, 2.0, 8.0), Effort.FULL: (0.5, 0.7, 1.0, 1.4, 2.0, 3.0, 4.0, 6.0, 8.0)}
CELLS_OF_RADIUS = {Effort.QUICK: 8, Effort.FULL: 16}
GRAVITY = 9.81
EXPONENT_BAND = 0.15
LUBE = Scaling("Lube et al. 2004, experiments", 1.24, 1.6, 0.5, 1.7)
LAJEUNESSE = Scaling("Lajeunesse et al. 2004, experiments", 1.0, 2.0, 0.5, 0.74)
SCALINGS = (LUBE, LAJEUNESSE)
# A published set of LIGGGHTS scripts, 22 801 beads: (r - r0)/r0 by aspect ratio, and the heights over r0 from a = 1 on.
GRAINS = {0.5: 0.50, 1.0: 1.25, 2.0: 2.42, 3.0: 3.42}
HEIGHTS_OF_GRAINS = (0.63, 0.71)
LOWEST_HIGH = 1.0
# Our own LIGGGHTS runs, 15 and 18 diameters in the radius, two packings each: where grains cover a tenth of the floor.
OWN_GRAINS = {0.5: 0.56, 1.0: 1.10, 2.0: 2.13}
RADIUS_BAND = 5e-2
# Between these, where both regimes meet, a value takes part in no exponent.
LOW, TALL = 1.0, 2.0


class Pile(NamedTuple):
    """Of a cylinder at rest.

    runout    (r - r0)/r0 up to the first cells without material, as of columns (`runout_scaling`)
    covered   (r - r0)/r0 up to where grains cover no more than `COVERED` of the floor
    radius    over r0, within which 98 % of the mass lies
    height    over r0
    """

    runout: float
    covered: float
    radius: float
    height: float


def changes(aspect_ratio: float, cell_size: float) -> dict[str, Any]:
    """What makes a cylinder of the shipped scene: its shape, the room it needs, and grains as stiff for any height."""
    height = aspect_ratio * RADIUS
    length = RADIUS * (2.0 + 1.5 * LAJEUNESSE.runout(max(1.0, aspect_ratio)))
    upper = [math.ceil(side / cell_size) * cell_size for side in (length, 1.1 * height)]
    return {
        "grid.cell_size": cell_size,
        "grid.upper": upper,
        "body.0.shape.upper": [RADIUS, height],
        f"material.{LAW}.bulk_modulus": 100.0 * 1500.0 * GRAVITY * height,
        "time.end": END * math.sqrt(height / GRAVITY),
    }


def pile(aspect_ratio: float, effort: Effort, friction: dict[str, float] | None = None) -> Pile:
    """Of a cylinder around its axis; with a friction of its own."""
    own = {f"material.{LAW}.{name}": value for name, value in (friction or {}).items()}
    simulation = shipped_simulation(SCENE, changes(aspect_ratio, RADIUS / CELLS_OF_RADIUS[effort]) | own)
    advance(simulation, simulation.scene.time.end)
    parameters = simulation.bodies[0].parameters
    solid = simulation.bodies[0].initial_density / parameters.grain_density
    least_depth = COVERED * 2.0 / 3.0 * parameters.grain_diameter / solid
    shape, runout, covered = (
        shape_of(simulation),
        runout_of(simulation, RADIUS),
        runout_of(simulation, RADIUS, least_depth),
    )
    return Pile(runout, covered, shape.runout / RADIUS, shape.height / RADIUS)


def height_of_lube(aspect_ratio: float) -> float:
    """The published fit, which ends where the cylinder keeps its height."""
    return min(aspect_ratio, 0.88 * aspect_ratio ** (1.0 / 6.0))


def within_published(aspect_ratio: float, found: Pile) -> tuple[Measurement, ...]:
    """How far runout and height lie outside the ranges of experiments and grains."""
    runouts = [scaling.runout(aspect_ratio) for scaling in SCALINGS]
    if aspect_ratio in GRAINS:
        runouts.append(GRAINS[aspect_ratio])
    heights = [height_of_lube(aspect_ratio)]
    if aspect_ratio >= LOWEST_HIGH:
        heights += HEIGHTS_OF_GRAINS
    label = f"a = {aspect_ratio:g}"
    return outside(f"{label}, runout", found.runout, runouts), outside(f"{label}, height", found.height, heights)


def of_grains(reference: ReferenceSet, series: str) -> dict[float, float]:
    """The last value of a series [m] over r0, by aspect ratio: the mean over the packings of our grains."""
    return {
        round(cylinders.aspect_ratio, 2): float(
            np.mean([run.of(series)[-1] / run.description["half_width"] for run in cylinders.runs])
        )
        for cylinders in reference.cylinders("glued")
    }


def beside_grains(reference: ReferenceSet, piles: dict[float, Pile]) -> list[Measurement]:
    """The radius of nearly all of the mass against that of our grains, to which the law is fitted: one definition."""
    return [
        relative_error(f"a = {a:g}, radius of 98 % of the mass, our grains", "1", piles[a].radius, own, RADIUS_BAND)
        for a, own in of_grains(reference, "radius_of_98_percent").items()
        if a in piles
    ]


def measure(effort: Effort) -> Evidence:
    """All cylinders; in full the exponents and prefactors of the low and the tall ones."""
    piles = {a: pile(a, effort) for a in ASPECT_RATIOS[effort]}
    runouts, covered, radii, heights = ({a: found[part] for a, found in piles.items()} for part in range(4))
    measurements = [measurement for a, found in piles.items() for measurement in within_published(a, found)]
    reference = read_reference_set()
    measurements += beside_grains(reference, piles)
    notes = [
        listed("(r - r0)/r0", runouts),
        listed(f"(r - r0)/r0 where grains cover {COVERED:g} of the floor", covered),
        listed("radius of 98 % of the mass over r0", radii),
        listed("height over r0", heights),
    ]
    if effort is Effort.FULL:
        laws = {
            "runout, low": (fitted({a: v for a, v in runouts.items() if a <= LOW}), 1.0),
            "runout, tall": (fitted({a: v for a, v in runouts.items() if a >= TALL}), 0.5),
            "height, from a = 1": (fitted({a: v for a, v in heights.items() if a >= LOWEST_HIGH}), 1.0 / 6.0),
        }
        measurements += [exponent(label, law, published) for label, (law, published) in laws.items()]
        notes += [f"{label}: {law}" for label, (law, _) in laws.items()]
    return Evidence(
        tuple(measurements),
        figures=figures(runouts, covered, heights, of_grains(reference, "height")),
        notes=tuple(notes),
    )


def exponent(label: str, law: PowerLaw, published: float) -> Measurement:
    """A fitted exponent against the published one."""
    return scaled_error(f"exponent of the {label}", "1", law.exponent, published, 1.0, EXPONENT_BAND)


def figures(
    runouts: dict[float, float],
    covered: dict[float, float],
    heights: dict[float, float],
    heights_of_grains: dict[float, float],
) -> tuple[Figure, ...]:
    """Both over the aspect ratio, with what was published, and our grains."""
    ratios, lowest, largest = np.geomspace(0.5, 8.0, 60), min(HEIGHTS_OF_GRAINS), max(HEIGHTS_OF_GRAINS)
    of_runout = [
        *(curve(one.source, ratios, [one.runout(a) for a in ratios], "reference") for one in SCALINGS),
        _points("grains, published", GRAINS, "control"),
        _points(f"our grains, {COVERED:g} of the floor covered", OWN_GRAINS, "control"),
        _points("mu(I)-LC", runouts),
        _points(f"mu(I)-LC, {COVERED:g} of the floor covered", covered),
    ]
    of_height = [
        curve(LUBE.source, ratios, [height_of_lube(a) for a in ratios], "reference"),
        curve("grains, published: lowest", [LOWEST_HIGH, 8.0], [lowest] * 2, "control"),
        curve("grains, published: highest", [LOWEST_HIGH, 8.0], [largest] * 2, "control"),
        _points("our grains", heights_of_grains, "control"),
        _points("mu(I)-LC", heights),
    ]
    axis = "a = H0/r0 [1]"
    return (
        Figure("Runout over aspect ratio", axis, "(r - r0)/r0 [1]", tuple(of_runout), logarithmic="xy"),
        Figure("Height over aspect ratio", axis, "height over r0 [1]", tuple(of_height), logarithmic="xy"),
    )


def _points(label: str, found: dict[float, float], role: str = "measured") -> Curve:
    return curve(label, list(found), list(found.values()), role)


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Hardly any friction."""
    found = pile(2.0, Effort.QUICK, {"static_friction": 0.05, "dynamic_friction": 0.43})
    return (*within_published(2.0, found), *beside_grains(read_reference_set(), {2.0: found}))


CASE = Case(
    name="cylinder_scaling",
    title="runout and height of cylinders over aspect ratio, axisymmetric",
    proves="cylinders of all shapes run as far, and stay as high, as experiments and grains have them",
    reference="Lube et al. (2004): 1.24 a, 1.6 sqrt(a) from a = 1.7 on, height 0.88 a^(1/6) r0; Lajeunesse et al. "
    "(2004): 1.0 a, 2.0 sqrt(a) from a = 0.74 on; 22 801 beads: 0.50, 1.25, 2.42, 3.42 at a = 0.5, 1, 2, 3, heights "
    "0.63 to 0.71 r0; the range between them is the reference (r0 is 15 grain diameters here); our grains",
    norm="share by which a value leaves the range; difference of the fitted exponents from 1, 1/2 and 1/6; relative "
    "error of the radius of 98 % of the mass",
    mistake="friction 0.05 to 0.43 instead of 0.53 to 0.91",
    measure=measure,
    control=control,
)
