"""Runout of columns from half as high as wide to sixteen times as high, against experiments and a continuum model."""

import math
from typing import Any, NamedTuple

import numpy as np

from grainlaw.mpm_core.output.observables import MASS_BETWEEN_FRONTS
from grainlaw.plugins.mu_i.friction import own_inertial_number_constant
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, scaled_error
from grainlaw.validation.cases.collapses.scaling import END, Scaling, fitted, listed, outside, runout_of
from grainlaw.validation.scenes import advance, simulation_of

ASPECT_RATIOS = {Effort.QUICK: (0.5, 2.0, 8.0), Effort.FULL: (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)}
CELLS_OF_WIDTH = {Effort.QUICK: 8, Effort.FULL: 16}
WIDTH, GRAVITY = 0.1, 9.81
TALL = 3.0
EXPONENT_BAND = 0.15
# Glass beads: mu(I) of Lagree, Staron & Popinet (2011), I_0 counted in the engineering rate.
FRICTION, SATURATION, REFERENCE_NUMBER = 0.32, 0.60, 0.4
SCALINGS = (
    Scaling("Lube et al. 2005, experiments in a channel", 1.2, 1.9, 2.0 / 3.0, TALL),
    Scaling("Lajeunesse et al. 2005, experiments in a channel", 1.2, 1.9, 2.0 / 3.0, TALL),
    Scaling("Lagree et al. 2011, mu(I) continuum", 2.2, 3.9, 0.7, TALL),
)


def scene(aspect_ratio: float, effort: Effort, static_friction: float) -> dict[str, Any]:
    """Half of a symmetric column, at a smooth wall, on a rough floor."""
    cell = WIDTH / CELLS_OF_WIDTH[effort]
    height = aspect_ratio * WIDTH
    length = WIDTH * (2.0 + 1.5 * SCALINGS[-1].runout(aspect_ratio))
    up = math.ceil(1.1 * height / cell) * cell
    return {
        "gravity": [0.0, -GRAVITY],
        "grid": {"cell_size": cell, "upper": [math.ceil(length / cell) * cell, up]},
        "boundary": {"bottom": {"kind": "friction", "coefficient": 1.0}},
        "time": {"end": END * math.sqrt(height / GRAVITY)},
        "material": {
            "mu_i_lc": {
                "static_friction": static_friction,
                "dynamic_friction": static_friction + SATURATION - FRICTION,
                "inertial_number_constant": own_inertial_number_constant(REFERENCE_NUMBER),
                "bulk_modulus": 100.0 * 1500.0 * GRAVITY * height,
                "poisson_ratio": 0.2,
                "grain_density": 2500.0,
                "grain_diameter": 0.001,
            }
        },
        "body": [
            {
                "material": "mu_i_lc",
                "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [WIDTH, height]},
                "density": 1500.0,
                "initial_stress": {"kind": "geostatic"},
            }
        ],
    }


class Runouts(NamedTuple):
    """(L - L_0)/L_0 at rest: up to the first column of cells without material, and up to 98 % of the mass."""

    front: float
    mass: float


def runouts(aspect_ratio: float, effort: Effort, static_friction: float = FRICTION) -> Runouts:
    """Of a column with a friction of its own."""
    simulation = simulation_of(scene(aspect_ratio, effort, static_friction))
    advance(simulation, simulation.scene.time.end)
    (body,) = simulation.bodies  # of points of equal mass
    within = float(np.quantile(body.positions[0], MASS_BETWEEN_FRONTS))
    return Runouts(runout_of(simulation, WIDTH), within / WIDTH - 1.0)


def within_published(aspect_ratio: float, found: float) -> Measurement:
    """How far a runout lies outside the range of the published fits, as a share of the nearer one."""
    return outside(f"a = {aspect_ratio:g}", found, [scaling.runout(aspect_ratio) for scaling in SCALINGS])


def measure(effort: Effort) -> Evidence:
    """All columns; in full the exponents of the low and the tall ones."""
    both = {a: runouts(a, effort) for a in ASPECT_RATIOS[effort]}
    found, of_mass = ({a: one[part] for a, one in both.items()} for part in range(2))
    measurements = [within_published(a, value) for a, value in found.items()]
    notes = [listed("(L - L_0)/L_0", found), listed("(L - L_0)/L_0 of 98 % of the mass", of_mass)]
    if effort is Effort.FULL:
        for label, chosen, published in (
            ("low", {a: v for a, v in found.items() if a < TALL}, 1.0),
            ("tall", {a: v for a, v in found.items() if a > TALL}, 2.0 / 3.0),
        ):
            law = fitted(chosen)
            measurements.append(
                scaled_error(f"exponent of {label} columns", "1", law.exponent, published, 1.0, EXPONENT_BAND)
            )
            notes.append(f"{label} columns: {law}")
    ratios = np.geomspace(0.5, 16.0, 60)
    curves = [curve(one.source, ratios, [one.runout(a) for a in ratios], "reference") for one in SCALINGS]
    curves.append(curve("mu(I)-LC", list(found), list(found.values())))
    curves.append(curve("mu(I)-LC, 98 % of the mass", list(of_mass), list(of_mass.values())))
    figure = Figure("Runout over aspect ratio", "a = H_0/L_0 [1]", "(L - L_0)/L_0 [1]", tuple(curves), logarithmic="xy")
    return Evidence(tuple(measurements), figures=(figure,), notes=tuple(notes))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Hardly any friction."""
    return (within_published(2.0, runouts(2.0, Effort.QUICK, static_friction=0.05).front),)


CASE = Case(
    name="runout_scaling",
    title="runout over aspect ratio",
    proves="columns of all shapes run as far as experiments and other codes have them run",
    reference="Lube et al. (2005) and Lajeunesse et al. (2005): 1.2 a, 1.9 a^(2/3); Lagree et al. (2011): 2.2 a, "
    "3.9 a^0.7; they differ by a factor of 1.8, so the range between them is the reference",
    norm="share by which the runout leaves the range; difference of the fitted exponents from 1 and 2/3",
    mistake="static friction 0.05 instead of 0.32",
    measure=measure,
    control=control,
)
