"""Laws in the element tests of the grains: what is measured, and that a wrong law is told."""

import pytest

from grainlaw.materials import get_material
from grainlaw.materials.calibration.data import read_data
from grainlaw.materials.calibration.model import ForwardModel, answer
from grainlaw.validation.dem.judging.element_verdicts import element_verdict
from grainlaw.validation.dem.judging.fitted_laws import FittedLaw
from grainlaw.validation.dem.judging.fitting_data import CYCLE_FILE, FLOW_FILE, PEAK_FILE, write_data
from grainlaw.validation.dem.judging.judged_laws import JUDGED_LAWS
from grainlaw.validation.grains.distance import Verdict
from grainlaw.validation.reference.reference_set import read_reference_set
from grainlaw.validation.report.grain_tables import element_table

START = ("peak friction", "strain of the peak", "friction after the peak", "dilation")
EVERY = (*START, "compression", "steady friction", "steady solid fraction")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("data")
    write_data(read_reference_set(), found, 2450.0, 0.015)
    return found


def fitted(**changes):
    (judged,) = (found for found in JUDGED_LAWS if found.law == "mu_i_state")
    values = get_material(judged.law).parameter_sets["dem"].parameters._asdict()
    return FittedLaw(judged, values | changes, (), (), "", ((), ()))


def verdicts(found):
    return {one.name: one.verdict for one in found.distances}


def test_the_unified_law_in_all_tests(folder):
    found = element_verdict(fitted(), folder)
    assert tuple(verdicts(found)) == EVERY
    beyond = [name for name, verdict in verdicts(found).items() if verdict is not Verdict.INDISTINGUISHABLE]
    assert beyond == ["friction after the peak"]
    row = element_table([found]).rows[0]
    assert row[-2:] == ("6 of 7", "")


def test_a_wrong_law_is_told(folder):
    found = verdicts(element_verdict(fitted(dilatancy_coefficient=0.0), folder))
    assert found["dilation"] is found["peak friction"] is Verdict.DIFFERS
    assert verdicts(element_verdict(fitted(stiffness=8e6), folder))["compression"] is Verdict.DIFFERS
    slippery = fitted(static_friction=0.4, dynamic_friction=0.6)
    assert verdicts(element_verdict(slippery, folder))["steady friction"] is Verdict.DIFFERS


def test_own_answers_are_met(folder, tmp_path):
    """The law's own friction and solid fraction in place of those of the grains."""
    law = get_material("mu_i_state")
    (data,) = read_data(folder / PEAK_FILE, law)
    result = ForwardModel(law, (data,)).history(data, fitted().parameters, data.abscissa)
    friction, fraction = (answer(result, measured) for measured in data.measured)
    head = [line for line in (folder / PEAK_FILE).read_text().splitlines() if not line[0].isdigit()]
    rows = [f"{e:g},{m:.9g},0.01,{f:.9g},0.001" for e, m, f in zip(data.abscissa, friction, fraction, strict=True)]
    (tmp_path / PEAK_FILE).write_text("\n".join([*head, *rows]) + "\n")
    found = element_verdict(fitted(), tmp_path)
    assert tuple(verdicts(found)) == START
    assert [abs(one.distance) < 1e-3 for one in found.distances] == [True] * 4


def test_a_test_that_cannot_be_followed_is_named(folder, tmp_path):
    for name in (FLOW_FILE, CYCLE_FILE):
        (tmp_path / name).write_text((folder / name).read_text().replace("isotropic", "isotropical"))
    found = element_verdict(fitted(), tmp_path)
    assert tuple(verdicts(found)) == ("steady friction", "steady solid fraction")
    assert "isotropical" in found.failures[0]
