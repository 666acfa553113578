"""Material that is torn open and closed ten times gains no volume."""

import math
from typing import Any

from grainlaw.materials.law import Law
from grainlaw.materials.registry import get_material
from grainlaw.materials.tensor import SymmetricTensor, isotropic, pressure
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error

BAND = 1e-9
PRESSURE, DENSITY = 1000.0, 1500.0
CYCLES, OPENING, STEPS = 10, 0.1, 50
LAWS = {
    "modified_cam_clay": "paper_ocr4",
    "mu_i_mcc": "paper_ocr4",
    "mu_i_lc": "paper",
    "mu_i_elastoplastic": "paper",
    "mu_i_phi_i": "paper",
    "mu_i_state": "paper",
    "drucker_prager": "aluminium_bars",
    "newtonian": "glycerol",
}


def cycled(law: Law, parameters: Any, forgets_opening: bool = False) -> list[tuple[float, float]]:
    """Volumetric strain (compression-positive) and pressure [Pa] over ten cycles of isotropic opening and closing."""
    stress = isotropic(-PRESSURE)
    density, strain = DENSITY, 0.0
    state = law.initial_state(stress, density, parameters)
    found = [(strain, PRESSURE)]
    for _ in range(CYCLES):
        for direction in (-1.0, 1.0):
            increment = direction * OPENING / STEPS
            for _ in range(STEPS):
                density *= math.exp(increment)
                strain += increment
                stress, state = step(law, parameters, stress, density, state, increment)
                if forgets_opening:
                    state = state._replace(opening_strain=0.0)
                found.append((strain, pressure(stress)))
    return found


def step(
    law: Law, parameters: Any, stress: SymmetricTensor, density: float, state: Any, increment: float
) -> tuple[SymmetricTensor, Any]:
    """One step of isotropic compression."""
    return law.update(stress, isotropic(-increment / 3.0), density, state, parameters, 1.0)


def returned(name: str, found: list[tuple[float, float]]) -> Measurement:
    """The pressure back at the initial volume."""
    return relative_error(f"{name}: pressure at the initial volume", "Pa", found[-1][1], PRESSURE, BAND)


def measure(effort: Effort) -> Evidence:
    """The laws that open."""
    results = {}
    for name, set_name in LAWS.items():
        law = get_material(name)
        results[name] = cycled(law, law.parameter_sets[set_name].parameters)
    curves = tuple(
        curve(name, [v for v, _ in found[-2 * STEPS :]], [p for _, p in found[-2 * STEPS :]])
        for name, found in results.items()
    )
    figure = Figure("The tenth cycle", "volumetric strain [1]", "p [Pa]", curves)
    return Evidence(tuple(returned(name, found) for name, found in results.items()), figures=(figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Modified Cam Clay that takes up pressure as soon as it is compressed."""
    law = get_material("modified_cam_clay")
    found = cycled(law, law.parameter_sets["paper_ocr4"].parameters, forgets_opening=True)
    return (returned("modified_cam_clay", found),)


CASE = Case(
    name="opening_and_closing",
    title="ten times open and closed",
    proves="opened material closes at the volume at which it opened: a pile cannot swell by being shaken",
    reference="the pressure of the start at the volume of the start",
    norm="relative error of the pressure",
    mistake="the opening strain of a point is forgotten at each step",
    measure=measure,
    control=control,
)
