"""Laws are found through one hook; whatever is wrong with one is refused by name, and the rest keeps working."""

import subprocess
import sys
from importlib.metadata import EntryPoint
from textwrap import dedent

import pytest

from grainlaw.materials import HOOK_VERSION, InputError, get_material, registry
from grainlaw.materials.law import OLDEST_HOOK_VERSION
from grainlaw.materials.registry import Registry

LAW_FILE = '''
"""Linear elasticity under another name, to be broken in one place at a time."""

from typing import Annotated, NamedTuple

from grainlaw.materials import Law, Parameter, ParameterSet, StateVariable, SymmetricTensor, hookimpl


class Parameters(NamedTuple):
    stiffness: {parameter}


class State(NamedTuple):
    damage: {state}


def initial_state(stress, density, parameters):
    return State(0.0)


def update(stress, strain_rate, density, state, parameters, dt):
    {body}
    return stress + parameters.stiffness * dt * strain_rate, state


def sound_speed(stress, density, state, parameters):
    return (parameters.stiffness / density) ** 0.5


@hookimpl
def grainlaw_materials():
    {hook}
    sets = {{"one": ParameterSet(Parameters({value}), "made up", lambda pressure, parameters: 1000.0)}}
    return [Law("{name}", "{summary}", Parameters, State, initial_state, update, sound_speed, sets{extra})]
'''

SOUND = {
    "parameter": 'Annotated[float, Parameter("Pa", "stiffness E", "(0, inf)")]',
    "state": 'Annotated[float, StateVariable("1", "damage d")]',
    "body": "pass",
    "hook": "pass",
    "value": "1e6",
    "name": "spring",
    "summary": "a spring",
    "extra": "",
}

FAULTS = {
    "no unit": ({"parameter": 'Annotated[float, Parameter("", "stiffness E")]'}, "'stiffness' declares no unit"),
    "bad unit": ({"parameter": 'Annotated[float, Parameter("kPa", "stiffness E")]'}, "declares the unit 'kPa'"),
    "no doc": ({"parameter": 'Annotated[float, Parameter("Pa", " ")]'}, "'stiffness' declares no doc"),
    "no declaration": ({"parameter": "float"}, "'stiffness' is not declared"),
    "bad interval": ({"parameter": 'Annotated[float, Parameter("Pa", "E", "0 to 1")]'}, "'stiffness': bounds '0 to 1'"),
    "state without unit": ({"state": 'Annotated[float, StateVariable("", "damage d")]'}, "'damage' declares no unit"),
    "state without doc": ({"state": 'Annotated[float, StateVariable("1", "")]'}, "'damage' declares no doc"),
    "no summary": ({"summary": ""}, "no summary"),
    "bad name": ({"name": "Spring-1"}, "'Spring-1' is not lower_case"),
    "later hook version": (
        {"extra": f", hook_version={HOOK_VERSION + 1}"},
        f"written for hook version {HOOK_VERSION + 1}; this grainlaw understands 1 to {HOOK_VERSION}: it needs a newer",
    ),
    "earlier hook version": (
        {"extra": f", hook_version={OLDEST_HOOK_VERSION - 1}"},
        f"written for hook version {OLDEST_HOOK_VERSION - 1}; this grainlaw understands 1 to {HOOK_VERSION}: the law",
    ),
    "hook version in words": ({"extra": ', hook_version="two"'}, "hook_version = 'two' is not a whole number"),
    "viscosity before its hook version": (
        {"extra": ", viscosity=sound_speed, hook_version=1"},
        "viscosity belongs to hook version 2; the law says hook_version=1",
    ),
    "set out of bounds": ({"value": "-1.0"}, "stiffness = -1.0 is outside (0, inf)"),
    "NaN at its own values": (
        {"body": 'return float("nan") * stress, state'},
        "gives a value that is not finite",
    ),
    "step that raises": ({"body": "1 / 0"}, "raises ZeroDivisionError"),
}


def plugin_file(folder, **changes):
    path = folder / "spring_plugin.py"
    path.write_text(LAW_FILE.format(**SOUND | changes))
    return path


def with_built_ins():
    found = Registry()
    found.load_entry_points()
    return found


def test_built_in_laws_are_registered_without_refusals():
    assert {"linear_elastic", "modified_cam_clay", "mu_i_lc", "mu_i_lc_viscous"} <= set(registry().laws)
    assert registry().refusals == []
    assert registry().laws["mu_i_lc"].origin.startswith("grainlaw ")


def test_file_adds_a_law(tmp_path):
    found = with_built_ins()
    path = plugin_file(tmp_path)
    found.load_file(path)
    assert found.get("spring").origin == str(path)
    assert found.get("spring").law.parameter_declarations["stiffness"].unit == "Pa"


@pytest.mark.parametrize("fault", FAULTS)
def test_faulty_law_is_refused_with_its_reason_and_the_rest_works(fault, tmp_path):
    changes, reason = FAULTS[fault]
    found = with_built_ins()
    known = set(found.laws)
    with pytest.raises(InputError) as error:
        found.load_file(plugin_file(tmp_path, **changes))
    assert reason in str(error.value)
    assert changes.get("name", "spring") in str(error.value)
    assert set(found.laws) == known


def test_refused_law_is_asked_for_by_name(tmp_path):
    found = with_built_ins()
    with pytest.raises(InputError):
        found.load_file(plugin_file(tmp_path, summary=""))
    with pytest.raises(InputError, match=r"refused 'spring' from .*: no summary"):
        found.get("spring")


def test_duplicate_name_is_refused_and_the_first_law_stays(tmp_path):
    found = with_built_ins()
    first = found.get("mu_i_lc").law
    with pytest.raises(InputError, match=r"law 'mu_i_lc': the name is taken by grainlaw"):
        found.load_file(plugin_file(tmp_path, name="mu_i_lc"))
    assert found.get("mu_i_lc").law is first


def test_raising_hook_is_refused(tmp_path):
    found = with_built_ins()
    with pytest.raises(InputError, match="hook grainlaw_materials raises RuntimeError: broken"):
        found.load_file(plugin_file(tmp_path, hook='raise RuntimeError("broken")'))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("raise RuntimeError('broken')", "import raises RuntimeError: broken"),
        ("x = 1", "implements no hook"),
        (
            """
            from grainlaw.materials import hookimpl
            @hookimpl
            def grainlaw_materials():
                return [1]
            """,
            "returned int, not a Law",
        ),
        (
            """
            from grainlaw.materials import hookimpl
            @hookimpl
            def grainlaw_materails():
                return []
            """,
            "unknown hook 'grainlaw_materails'",
        ),
    ],
)
def test_file_that_is_no_plugin_is_refused(text, reason, tmp_path):
    path = tmp_path / "no_plugin.py"
    path.write_text(dedent(text))
    with pytest.raises(InputError) as error:
        Registry().load_file(path)
    assert reason in str(error.value)


@pytest.mark.parametrize(("extra", "version"), [("", HOOK_VERSION), (", hook_version=1", 1)])
def test_law_is_for_the_present_interface_unless_it_states_an_older_one(extra, version, tmp_path):
    found = Registry()
    found.load_file(plugin_file(tmp_path, extra=extra))
    assert found.get("spring").law.hook_version == version


def test_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="no file"):
        Registry().load_file(tmp_path / "absent.py")


def test_broken_installed_plugin_stops_no_other(monkeypatch):
    broken = EntryPoint("broken", "grainlaw_test_of_an_absent_module", "grainlaw.materials")
    sound = EntryPoint("mu_i_lc", "grainlaw.plugins.mu_i_lc", "grainlaw.materials")
    monkeypatch.setattr(sys.modules[Registry.__module__], "entry_points", lambda group: [broken, sound])
    found = Registry()
    found.load_entry_points()
    assert set(found.laws) == {"mu_i_lc"}
    assert [refusal.name for refusal in found.refusals] == ["broken"]
    assert "ModuleNotFoundError" in found.refusals[0].reason


def test_unknown_law_names_the_nearest():
    with pytest.raises(InputError, match="unknown law 'mu_lc'; did you mean 'mu_i_lc'"):
        get_material("mu_lc")


def test_law_that_does_not_compile_is_refused_by_name(tmp_path):
    from grainlaw.materials.element.catalogue import get_element_test
    from grainlaw.materials.element.run import run_element_test
    from grainlaw.materials.element.specimen import Specimen

    found = Registry()
    found.load_file(plugin_file(tmp_path, body='print({}, file=None, sep="".join(sorted("b")), end="")'))
    law = found.get("spring").law
    test = get_element_test("isotropic")
    specimen = Specimen(law, law.parameter_sets["one"].parameters, "spring", "made up")
    with pytest.raises(InputError, match=r"law 'spring' \(spring_plugin.py\) does not compile"):
        run_element_test(test, specimen, test.settings())


def test_a_file_of_laws_leaves_nothing_that_needs_it_in_the_cache_of_other_laws(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    command = [sys.executable, "-m", "grainlaw", "element", "isotropic", "--material", "mu_i_lc"]
    beside = ["--material", "spring", "--plugin", str(plugin_file(tmp_path))]
    # the file's law first, so that the compiler knows its state before the other's
    subprocess.run([*command[:4], *beside, *command[4:]], check=True, capture_output=True)
    subprocess.run(command, check=True, capture_output=True)
