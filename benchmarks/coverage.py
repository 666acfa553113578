"""`python -m benchmarks.coverage`: how often the 90 % bands of `grainlaw predict` hold a synthetic truth.

Each case draws true frictions, measures them in a noisy shear test, calibrates, makes bands of a coarse column from the
calibration, and looks whether they hold the true column: on the grid of the bands, and on half of its cells with its
points at a place of their own, which the numerical spread has to cover.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import typer
from numpy.typing import NDArray

from grainlaw.materials import get_material
from grainlaw.materials.calibration.data import DataSet, Measured
from grainlaw.materials.calibration.experiments import get_experiment
from grainlaw.materials.calibration.findings import Findings
from grainlaw.materials.calibration.fit import fit_to_data
from grainlaw.materials.calibration.model import ForwardModel, answer
from grainlaw.materials.calibration.parameter_file import calibrated_of
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.scene.shipped import shipped_scenes
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.studies.bands import Array, Band
from grainlaw.studies.draws import drawn
from grainlaw.studies.ensemble import drawn_members, numerical_members, plan
from grainlaw.studies.predict import band_of
from grainlaw.validation.grains.distance import surface_at
from grainlaw.validation.grains.material_points import snapshot_of_bodies
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.observe import observe
from grainlaw.validation.grains.run_observation import as_grains

LAW = get_material("mu_i_lc")
FITTED = ("static_friction", "dynamic_friction")
# Soft, for longer steps.
COARSE = {"grid.cell_size": 0.025, "time.end": 0.6, "material.mu_i_lc.bulk_modulus": 100e3}
# Of the true frictions, and standard deviations of them and of a measurement.
FRICTION, RANGE, NOISE = (0.5, 0.9), (0.05, 0.1), 0.03
NUMBERS = np.geomspace(0.003, 1.0, 6)
WIDTH, GRAIN_DENSITY = 0.015, 2450.0
Values = dict[str, float]
Hits = dict[tuple[str, str], float]


def observed(content: Mapping[str, Any]) -> Observation:
    """The start and the end of a scene that is run here, looked at as grains are."""
    scene = Scene.from_dict(dict(content))
    simulation = Simulation(scene)
    start = snapshot_of_bodies(0.0, simulation.bodies, GRAIN_DENSITY)
    at_start = Simulation(scene).bodies
    simulation.advance_to(scene.time.end)
    snapshots = [start, snapshot_of_bodies(simulation.time, simulation.bodies, GRAIN_DENSITY)]
    setting, whole = as_grains(scene, at_start, snapshots, WIDTH, GRAIN_DENSITY)
    return observe(whole, setting, {})


def hits_of_case(scene: Scene, number: int, samples: int) -> Hits:
    """Whether bands hold a truth, by the band and what it is of; of the profile the share of its width."""
    random = np.random.default_rng(number)
    start = {**scene.parameters(LAW.name)._asdict(), **dict(zip(FITTED, FRICTION, strict=True))}
    truth = {**start, **{name: random.normal(start[name], one) for name, one in zip(FITTED, RANGE, strict=True)}}
    calibrated = calibrated_of(Findings(fit_to_data(LAW, [measured(truth, random)], FITTED, start)))
    prepared = plan(scene, LAW, calibrated.values)
    members = [*numerical_members(prepared), *drawn_members(prepared, drawn(calibrated, samples, number))]
    seen = {member.name: observed(member.scene) for member in members}
    elsewhere = {
        "grid.cell_size": 0.5 * scene.grid.cell_size,
        "body.0.lattice_shift": [random.uniform(-0.5, 0.5), 0.0],
    }
    truths = {"same grid": {}, "half the cells": elsewhere}
    found: Hits = {}
    for place, changes in truths.items():
        found |= _hits(seen, observed(prepared.with_parameters(truth, changes)), place)
    return found


def measured(truth: Values, random: np.random.Generator) -> DataSet:
    """Steady shear at six inertial numbers, with noise."""
    errors = np.full(len(NUMBERS), NOISE)
    settings = {"held_normal_stress": 1000.0, "strain_to_steady": 0.4, "strain_step": 1e-2}
    blank = (Measured("friction", np.zeros(len(NUMBERS)), errors),)
    data = DataSet("shear", get_experiment("steady-shear"), "inertial_number", NUMBERS, settings, blank)
    exact = answer(ForwardModel(LAW, (data,)).history(data, truth, NUMBERS), blank[0])
    return replace(data, measured=(Measured("friction", random.normal(exact, NOISE), errors),))


def _hits(seen: Mapping[str, Observation], truth: Observation, place: str) -> Hits:
    x = max((one.x for one in seen.values()), key=len)
    end = float(truth.times[-1])
    found: Hits = {}
    for name in ("runout", "height"):
        bands = band_of({key: one.of(name)[-1:] for key, one in seen.items()})
        found |= _held(bands, truth.of(name)[-1:], np.array([True]), f"{name}, {place}")
    profile = band_of({key: surface_at(one, end, x) for key, one in seen.items()})
    surface = surface_at(truth, end, x)
    there = np.maximum(surface, profile.upper) > WIDTH
    return found | _held(profile, surface, there, f"profile, {place}")


def _held(bands: Band, values: Array, there: NDArray[np.bool_], name: str) -> Hits:
    of_draws = (bands.drawn_lower <= values) & (values <= bands.drawn_upper)
    return {
        ("draws", name): float(of_draws[there].mean()),
        ("with numerics", name): float(bands.holds(values)[there].mean()),
    }


def main(
    cases: Annotated[int, typer.Option("--cases", min=1, help="Synthetic truths.")] = 40,
    samples: Annotated[int, typer.Option("--samples", min=19, help="Draws of each case.")] = 24,
) -> None:
    """Print the share of cases in which each band holds the truth."""
    scene = Scene.load(shipped_scenes()["dem_column"], dict(COARSE))
    hits: list[Hits] = []
    for number in range(cases):
        hits.append(hits_of_case(scene, number, samples))
        if number % 5 == 4 or number == cases - 1:
            typer.echo(f"{number + 1} cases")
            for key in hits[0]:
                share = np.mean([found[key] for found in hits])
                typer.echo(f"  {', '.join(key):50} {100.0 * share:5.1f} %")


if __name__ == "__main__":
    typer.run(main)
