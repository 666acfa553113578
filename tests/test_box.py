"""Boxes of material under its own weight: a fluid keeps its height, and the check finds the law that does not."""

from pathlib import Path

import numpy as np
import pytest
from scenes_for_tests import fresh_registry, simulation  # noqa: F401

from grainlaw.materials import InputError, get_material
from grainlaw.materials.conformance.subject import Subject
from grainlaw.materials.conformance.suite import QUICK, examine
from grainlaw.validation.box import BOX, box, bulk_modulus

DEPTH, DENSITY, GRAVITY = 0.5, 1500.0, 9.81
FLUID = {
    "gravity": [0.0, -GRAVITY],
    "grid": {"cell_size": 0.05, "upper": [0.5, 1.0]},
    "time": {"end": 0.3},
    "material": {
        "drucker_prager": {
            "friction_angle": 0.0,
            "dilatancy_angle": 0.0,
            "cohesion": 0.0,
            "bulk_modulus": 1e6,
            "poisson_ratio": 0.3,
        }
    },
    "body": [
        {
            "material": "drucker_prager",
            "density": DENSITY,
            "shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [0.5, DEPTH]},
            "initial_stress": {"kind": "geostatic"},
        }
    ],
}


def verdict(law):
    ((_, outcome),) = examine(law, QUICK, (BOX,))
    return outcome


@pytest.mark.parametrize("horizontal_ratio", [0.5, 1.0])
def test_box_of_a_material_without_strength_is_a_fluid_at_rest(horizontal_ratio):
    """From an isotropic start it stays; a deviator is lost at once, and waves remain around the same equilibrium."""
    moved = simulation(FLUID, {"body.0.initial_stress.horizontal_ratio": horizontal_ratio})
    (body,) = moved.bodies
    heights = np.sort(body.positions[1])
    moved.advance_to(FLUID["time"]["end"])
    settlement = heights - np.sort(body.positions[1])
    # all of the weight on a bulk modulus, at most
    assert np.abs(settlement).max() < DENSITY * GRAVITY * DEPTH**2 / 1e6
    mean = -(body.stress[0] + body.stress[1] + body.stress[2]).mean() / 3.0
    assert mean == pytest.approx(0.5 * DENSITY * GRAVITY * DEPTH, rel=0.05 if horizontal_ratio == 1.0 else 0.3)


@pytest.mark.parametrize("name", ["drucker_prager", "neo_hookean"])
def test_built_in_law_keeps_its_height(name):
    outcome = verdict(get_material(name))
    assert outcome.verdict == "pass", outcome.reason
    assert "keeps its height to 0.0%" in outcome.reason


def test_law_that_loses_its_pressure_at_the_end_of_its_bounds_sinks(tmp_path, fresh_registry):  # noqa: F811
    text = Path(get_material("drucker_prager").source_file).read_text()
    carried = "    if new_pressure > apex:\n        return isotropic(-new_pressure), State(0.0)\n"
    assert text.count(carried) == 1
    path = tmp_path / "sinking_cone.py"
    path.write_text(text.replace(carried, "").replace('name="drucker_prager"', 'name="sinking_cone"'))
    fresh_registry.load_file(path)
    outcome = verdict(fresh_registry.get("sinking_cone").law)
    assert outcome.verdict == "FAIL"
    assert "a box of it changes its height by -" in outcome.reason
    assert "friction_angle = 0" in outcome.reason


@pytest.mark.parametrize("name", ["linear_elastic", "drucker_prager", "neo_hookean"])
def test_weight_of_the_box_is_a_small_share_of_the_bulk_modulus(name):
    subject = Subject(get_material(name), next(iter(get_material(name).parameter_sets)), QUICK)
    modulus = subject.parameters.bulk_modulus
    assert bulk_modulus(subject, subject.parameters) == pytest.approx(modulus, rel=0.01)
    scene = box(subject, subject.parameters)
    assert -scene["gravity"][1] * scene["body"][0]["density"] == pytest.approx(0.005 * modulus, rel=0.01)


@pytest.mark.parametrize(("name", "density"), [("mu_i_lc", 0.6 * 2450.0), ("mu_i_phi_i", 0.5434 * 2450.0)])
def test_box_is_not_denser_than_the_grains(name, density):
    subject = Subject(get_material(name), next(iter(get_material(name).parameter_sets)), QUICK)
    assert box(subject, subject.parameters)["body"][0]["density"] == pytest.approx(density)


def test_law_without_an_answer_to_compression_is_refused(monkeypatch):
    subject = Subject(get_material("linear_elastic"), "soft_solid", QUICK)
    monkeypatch.setattr("grainlaw.validation.box.bulk_modulus", lambda subject, parameters: 0.0)
    with pytest.raises(InputError, match="a small compression changes the pressure by 0 Pa"):
        box(subject, subject.parameters)
