"""The conformance suite: the built-in laws pass it, and each deliberate mistake is caught by the check of its name."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from documentation import DOCS

from grainlaw import plugins
from grainlaw.materials import get_material, registry
from grainlaw.materials.conformance.finished import finished, unfinished
from grainlaw.materials.conformance.subject import Subject
from grainlaw.materials.conformance.suite import CHECKS, QUICK, examine
from grainlaw.materials.registry import Registry

SOUND_LAW = (DOCS / "adding-a-law.md").read_text().partition("```python file=cemented_sand.py\n")[2].partition("```")[0]
STRENGTH = "    strength = parameters.friction_coefficient * p + cohesion if p > 0.0 else 0.0\n"
FACTOR = "shear_stress / max(trial_shear_stress, 1e-300) * trial"
RETURNED = f"    return assembled_stress(p, {FACTOR}), new_state\n"
MISTAKES = {
    "finished": ("parameters.friction_coefficient * p + cohesion", "0.6 * p + cohesion"),
    "dissipation": (
        RETURNED,
        RETURNED.replace(
            "shear_stress / max(trial_shear_stress, 1e-300) * trial", "-dt * modulus * deviator(strain_rate)"
        ),
    ),
    "sound speed": ("parameters.bulk_modulus + max(0.0, pressure(stress))", "0.1 * parameters.bulk_modulus"),
    "stored energy": ("return isotropic_part + energy_of_shear", "return isotropic_part + 1.1 * energy_of_shear"),
    "pure": (STRENGTH, STRENGTH + "    CALLS.append(p)\n    strength *= 1.0 + 1e-3 * len(CALLS)\n"),
    "finite": (STRENGTH, STRENGTH + "    p = p * p / p if p >= 0.0 else p\n"),
    "objectivity": (STRENGTH, STRENGTH + "    strength *= 1.0 + 0.1 * abs(stress.xy) / (abs(stress.xy) + 100.0)\n"),
    "tension": ("p = max(0.0, parameters.bulk_modulus * compression)", "p = parameters.bulk_modulus * compression"),
    "units": ("cohesion if p > 0.0", "cohesion + 100.0 if p > 0.0"),
    "equilibrium": (STRENGTH, STRENGTH + "    p *= 1.0 + 1e-3\n"),
    "convergence": (RETURNED, RETURNED.replace("shear_stress /", "0.999 * shear_stress /")),
    "bounds": (STRENGTH, STRENGTH + "    strength += math.sqrt(0.45 - parameters.poisson_ratio)\n"),
    "single": (STRENGTH, STRENGTH + "    strength += (1.0 + 1e-9 * p - 1.0) * 1e9\n"),
    "compiled": (STRENGTH, STRENGTH + "    strength = [strength, p][0] if isinstance(p, float) else eval('p')\n"),
}


def verdicts(law):
    return {check.name: outcome for check, outcome in examine(law, QUICK)}


def law_of(text, folder):
    path = folder / "law_under_test.py"
    path.write_text(text.replace("class Parameters", "CALLS = []\n\n\nclass Parameters", 1))
    found = Registry()
    found.load_file(path)
    return found.get("cemented_sand").law


@pytest.mark.parametrize("name", sorted(registry().laws))
def test_built_in_law_passes(name):
    found = verdicts(registry().get(name).law)
    assert {check: outcome.reason for check, outcome in found.items() if outcome.verdict == "FAIL"} == {}


def test_sound_law_passes(tmp_path):
    found = verdicts(law_of(SOUND_LAW, tmp_path))
    assert [outcome for outcome in found.values() if outcome.verdict == "FAIL"] == []
    assert [name for name, outcome in found.items() if outcome.verdict == "skipped"] in ([], ["ptx"])
    assert all(outcome.reason for outcome in found.values())


@pytest.mark.parametrize("name", MISTAKES)
def test_deliberate_mistake_is_caught_by_name(name, tmp_path):
    old, new = MISTAKES[name]
    assert SOUND_LAW.count(old) == 1
    outcome = verdicts(law_of(SOUND_LAW.replace(old, new), tmp_path))[name]
    assert outcome.verdict == "FAIL", outcome.reason


def test_law_that_loses_its_pressure_at_the_end_of_its_bounds_is_caught(tmp_path):
    text = Path(get_material("drucker_prager").source_file).read_text()
    carried = "    if new_pressure > apex:\n        return isotropic(-new_pressure), State(0.0)\n"
    assert text.count(carried) == 1
    path = tmp_path / "unsound_cone.py"
    path.write_text(text.replace(carried, "").replace('name="drucker_prager"', 'name="unsound_cone"'))
    found = Registry()
    found.load_file(path)
    outcomes = verdicts(found.get("unsound_cone").law)
    assert [name for name, outcome in outcomes.items() if outcome.verdict == "FAIL"] == ["bounds"]
    assert "compression by 1% takes the pressure from 1000 to -0 Pa" in outcomes["bounds"].reason


TEMPLATE = Path(plugins.__file__).parent / "template" / "coulomb_example.py"
UNWRITTEN, WRITTEN = (
    "    factor = 1.0 if p > 0.0 else 0.0\n",
    "    factor = min(1.0, parameters.critical_state_ratio * p / max(deviatoric_stress(trial), 1e-300))\n",
)


def template_law(text, folder):
    path = folder / "coulomb_example.py"
    path.write_text(text.replace("    deviator,\n", "    deviator,\n    deviatoric_stress,\n"))
    found = Registry()
    found.load_file(path)
    return found.get("coulomb_example").law


def test_what_is_left_to_write_in_a_template_is_said_a_line_for_each_thing(tmp_path):
    law = template_law(TEMPLATE.read_text(), tmp_path)
    parameter, *lines = unfinished(law)
    assert parameter == "parameter critical_state_ratio is declared, but update does not use it"
    assert [re.match(r"coulomb_example.py, line \d+: ", line) is not None for line in lines] == [True] * 3
    assert "the return to the yield surface (3) is still to be written" in lines[1]
    outcome = finished(Subject(law, "sand", QUICK))
    assert (outcome.verdict, outcome.reason) == ("FAIL", "declared, but not used by `update`: critical_state_ratio")


def test_template_whose_update_is_written_has_only_its_words_left(tmp_path):
    text = TEMPLATE.read_text()
    assert text.count(UNWRITTEN) == 1
    law = template_law(text.replace(UNWRITTEN, WRITTEN), tmp_path)
    assert finished(Subject(law, "sand", QUICK)).verdict == "pass"
    assert len(unfinished(law)) == 3


@pytest.mark.parametrize("use", ["parameters[0]", "tuple(parameters)[0]", "getattr(parameters, FIELD)"])
def test_parameter_that_is_used_without_its_name_is_used(use, tmp_path):
    text = SOUND_LAW.replace(STRENGTH, STRENGTH.replace("parameters.friction_coefficient", use))
    text = text.replace("class State", "FIELD = 'friction_coefficient'\n\n\nclass State")
    assert finished(Subject(law_of(text, tmp_path), "weak", QUICK)).verdict == "pass"


def test_every_check_has_its_deliberate_mistake():
    without = {"declarations", "viscosity", "ptx", "cost"}
    assert {check.name for check in CHECKS} == MISTAKES.keys() | without


@pytest.mark.parametrize(
    ("old", "new", "fails"),
    [
        ("    viscosity=viscosity,\n", "", "sound speed"),
        ("return 4.0 / 3.0 * parameters.viscosity", "return parameters.viscosity", "viscosity"),
    ],
    ids=["undeclared", "too small"],
)
def test_viscosity_has_to_be_declared_in_full(old, new, fails, tmp_path):
    text = Path(get_material("newtonian").source_file).read_text()
    assert text.count(old) == 1
    path = tmp_path / "viscous_law.py"
    path.write_text(text.replace(old, new).replace('name="newtonian"', 'name="viscous_law"'))
    found = Registry()
    found.load_file(path)
    outcomes = verdicts(found.get("viscous_law").law)
    assert [name for name, outcome in outcomes.items() if outcome.verdict == "FAIL"] == [fails]


def test_step_that_a_viscosity_asks_for_is_stated():
    assert "explicit steps up to 6.7e-10 s" in verdicts(get_material("mu_i_lc_viscous"))["viscosity"].reason


def test_header_without_equations_is_caught(tmp_path):
    text = '"""A law."""\n' + SOUND_LAW.partition('"""\n')[2]
    assert verdicts(law_of(text, tmp_path))["declarations"].reason.startswith("the header of law_under_test.py")


def test_tension_may_be_declared(tmp_path):
    text = SOUND_LAW.replace(*MISTAKES["tension"]).replace(
        "    holds_in_single=True,", "    holds_in_single=True, carries_tension=True,"
    )
    outcome = verdicts(law_of(text, tmp_path))["tension"]
    assert (outcome.verdict, outcome.reason.startswith("declared")) == ("pass", True)


def test_command_prints_one_line_per_check_and_exits_1_on_failure(tmp_path):
    path = tmp_path / "cemented_sand.py"
    path.write_text(SOUND_LAW.replace(*MISTAKES["sound speed"]))
    done = check(path)
    assert done.returncode == 1
    assert re.search("sound speed +FAIL", done.stdout)
    assert "cemented_sand: fails sound speed" in done.stdout
    assert "unfinished" not in done.stdout
    assert all(found.name in done.stdout for found in CHECKS)
    path.write_text(SOUND_LAW)
    done = check(path)
    assert done.returncode == 0, done.stdout
    assert "passes every check" in done.stdout


def test_command_lists_what_is_left_to_write():
    done = check(TEMPLATE)
    assert done.returncode == 1
    assert "\nunfinished: parameter critical_state_ratio is declared, but update does not use it\n" in done.stdout
    assert done.stdout.count("\nunfinished: coulomb_example.py, line ") == 3
    assert done.stdout.endswith("coulomb_example: fails finished\n")


def check(plugin: Path):
    return subprocess.run(
        [sys.executable, "-m", "grainlaw", "check", plugin.stem, "--quick", "--plugin", str(plugin)],
        capture_output=True,
        text=True,
        check=False,
    )


def test_parameter_that_only_a_closure_of_another_file_names_is_used(tmp_path):
    """Nor is it read along the paths of the check: the branch is not taken there."""
    (tmp_path / "family.py").write_text(
        "from grainlaw.materials import pointwise\n\n\n"
        "def strength_of(rare):\n"
        "    @pointwise\n"
        "    def strength(p, parameters):\n"
        "        return rare(parameters) if p > 1e30 else 0.6 * p\n\n"
        "    return strength\n\n\n"
        "@pointwise\n"
        "def rare(parameters):\n"
        "    return parameters.friction_coefficient\n\n\n"
        "strength = strength_of(rare)\n"
    )
    text = SOUND_LAW.replace("import math\n", "import math\n\nfrom family import strength as strength_of_grains\n")
    used = "    strength = strength_of_grains(p, parameters) + cohesion if p > 0.0 else 0.0\n"
    assert finished(Subject(law_of(text.replace(STRENGTH, used), tmp_path), "weak", QUICK)).verdict == "pass"
