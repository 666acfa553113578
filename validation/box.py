"""The check of a law in a box: under its own weight it stays where it is, with parameters at the ends of their bounds.

A square of the material, around an axis a cylinder and in three dimensions a cube, stands in a box with smooth walls,
in equilibrium with its weight. Gravity is such that the pressure at the bottom is a small share of the bulk modulus. It
takes half of the time of a free fall from the top: material that lost its pressure would by then have fallen by a
quarter of its height.
"""

import math
import warnings
from typing import Any

import numpy as np

from grainlaw.materials import InputError, SimulationError, isotropic, pressure
from grainlaw.materials.conformance.declared import at_ends_of_bounds, listed
from grainlaw.materials.conformance.outcome import Check, Outcome
from grainlaw.materials.conformance.subject import DT, Subject
from grainlaw.materials.errors import InputWarning
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.mpm_core.space import PLANE_STRAIN, Space
from grainlaw.validation.scenes import block

SIDE, CELLS = 1.0, 6
# Of the bulk modulus.
PRESSURE_SHARE = 0.005
PROBE_STRAIN = 1e-6
# Solid fraction.
USUAL_PACKING = 0.6
# Draws with all parameters at some end of their bounds.
CORNERS = 10
# Of the height.
LARGEST_CHANGE = 0.02


def measure(subject: Subject) -> Outcome:
    """The largest change of height of the box; the law is taken from the registry, as a scene takes it."""
    draws, worst = 0, 0.0
    for values in at_ends_of_bounds(subject, np.random.default_rng(0), CORNERS):
        parameters = subject.law.parameters(**values)
        if subject.law.inconsistency(parameters):
            continue
        draws += 1
        try:
            change = height_change(subject, parameters)
        except (InputError, SimulationError, ArithmeticError, ValueError) as error:
            return Outcome("FAIL", f"{type(error).__name__}: {error}; at {listed(values)}")
        if not abs(change) <= LARGEST_CHANGE:
            return Outcome("FAIL", f"a box of it changes its height by {change:.0%} at {listed(values)}")
        worst = max(worst, abs(change))
    return Outcome("pass", f"a box of it keeps its height to {worst:.1%} in {draws} draws at the ends of the bounds")


def height_change(subject: Subject, parameters: Any, space: Space = PLANE_STRAIN) -> float:
    """The change of the height of the points' centre, relative to that height."""
    scene = Scene.from_dict(box(subject, parameters, space))
    with warnings.catch_warnings():
        # The uppermost points of Cam Clay start with little pressure, as in any geostatic scene.
        warnings.simplefilter("ignore", InputWarning)
        simulation = Simulation(scene)
    (body,) = simulation.bodies
    before = float(body.positions[space.up].mean())
    simulation.advance_to(scene.time.end)
    return float(body.positions[space.up].mean()) / before - 1.0


def box(subject: Subject, parameters: Any, space: Space = PLANE_STRAIN) -> dict[str, Any]:
    """The scene as tables. Raises InputError if the law does not answer a small compression with pressure."""
    law = subject.law.name
    bottom_pressure = PRESSURE_SHARE * bulk_modulus(subject, parameters)
    if not 0.0 < bottom_pressure < math.inf:
        raise InputError(f"a small compression changes the pressure by {bottom_pressure / PRESSURE_SHARE:g} Pa a unit")
    density = packed_density(subject, bottom_pressure, parameters)
    gravity = bottom_pressure / (density * SIDE)
    across = space.axes - 1
    return {
        "space": space.name,
        "gravity": [*[0.0] * across, -gravity],
        "grid": {"cell_size": SIDE / CELLS, "upper": [*[SIDE] * across, 1.5 * SIDE]},
        "time": {"end": 0.5 * math.sqrt(2.0 * SIDE / gravity)},
        "material": {law: parameters._asdict()},
        "body": [
            {
                "material": law,
                "density": density,
                "shape": block([0.0] * space.axes, [SIDE] * space.axes),
                "initial_stress": {"kind": "geostatic"},
            }
        ],
    }


def packed_density(subject: Subject, mean_pressure: float, parameters: Any) -> float:
    """Bulk density [kg/m3] at rest; of a usual packing where the line of a set is nominal, above the grains'."""
    density = subject.parameter_set.density(mean_pressure, parameters)
    grain_density = getattr(parameters, "grain_density", math.inf)
    return density if density <= grain_density else USUAL_PACKING * grain_density


def bulk_modulus(subject: Subject, parameters: Any) -> float:
    """The pressure [Pa] per unit of a small compression, from rest under the pressure of the subject."""
    law, stress = subject.law, isotropic(-subject.pressure)
    density = subject.parameter_set.density(subject.pressure, parameters)
    state = law.initial_state(stress, density, parameters)
    strain_rate = isotropic(-PROBE_STRAIN / 3.0 / DT)
    new, _ = law.update(stress, strain_rate, density * math.exp(PROBE_STRAIN), state, parameters, DT)
    return (pressure(new) - subject.pressure) / PROBE_STRAIN


BOX = Check(
    "box",
    "in a scene, a box of it keeps its height with parameters at the ends of their bounds; left out by `--quick`",
    measure,
)
