"""Laws in the element tests of the grains: what is measured, and that a wrong law is told."""

import pytest

from grainlaw.materials import get_material
from grainlaw.materials.calibration.data import read_data
from grainlaw.materials.calibration.model import ForwardModel, answer
from grainlaw.validation.dem.judging.element_verdicts import element_verdict
from grainlaw.validation.dem.judging.fitted_laws import FittedLaw
from grainlaw.validation.dem.judging.fitting_data import CYCLE_FILE, FLOW_FILE, PEAK_FILE, write_data
from grainlaw.validation.dem.judging.history_data import (
    LOOSE_FILE,
    MEDIUM_FILE,
    RATE_DROP_FILE,
    RATE_JUMP_FILE,
    REVERSAL_FILE,
    SLOWING_FILE,
    TRIAXIAL_FILE,
)
from grainlaw.validation.dem.judging.judged_laws import JUDGED_LAWS
from grainlaw.validation.grains.distance import Verdict
from grainlaw.validation.reference.reference_set import read_reference_set
from grainlaw.validation.report.grain_tables import element_table

START = ("peak friction", "strain of the peak", "friction after the peak", "dilation")
STEADY = ("steady friction", "steady solid fraction")
PRESSED = ("other pressures: steady friction", "other pressures: steady solid fraction")
HISTORIES = ("from medium", "from loose", "rate drop", "rate jump", "fast flow slowed", "reversal")
TRIAXIAL = ("triaxial peak", "triaxial q/p after the peak", "triaxial dilation")
MEANS = (MEDIUM_FILE, LOOSE_FILE, RATE_DROP_FILE, RATE_JUMP_FILE, SLOWING_FILE, REVERSAL_FILE)


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
    """What it was fitted to, and what it was not."""
    found = element_verdict(fitted(), folder)
    names = [f"{test}: {what}" for test in HISTORIES for what in ("friction", "packing")]
    assert set(verdicts(found)) == {*START, "compression", *STEADY, *PRESSED, *names, *TRIAXIAL}
    within = {name for name, verdict in verdicts(found).items() if verdict is Verdict.INDISTINGUISHABLE}
    assert {*START, "compression", *STEADY} - within == {"strain of the peak"}
    beyond = {name for name, verdict in verdicts(found).items() if verdict is Verdict.DIFFERS}
    assert {"reversal: friction", "fast flow slowed: friction", "triaxial q/p after the peak"} <= beyond
    table = element_table([found])
    assert table.columns == ("what", "band", "mu(I), state")
    assert table.rows[-1] == ("within", "", f"{len(within)} of {len(verdicts(found))}")
    (row,) = (row for row in table.rows if row[0] == "strain of the peak")
    assert row[2].endswith("% ~")


def test_a_wrong_law_is_told(folder):
    found = verdicts(element_verdict(fitted(dilatancy_coefficient=0.0), folder))
    assert found["dilation"] is found["peak friction"] is found["triaxial dilation"] is Verdict.DIFFERS
    assert verdicts(element_verdict(fitted(stiffness=8e6), folder))["compression"] is Verdict.DIFFERS
    slippery = verdicts(element_verdict(fitted(static_friction=0.4, dynamic_friction=0.6), folder))
    assert slippery["steady friction"] is slippery["rate drop: friction"] is Verdict.DIFFERS
    assert slippery["other pressures: steady friction"] is slippery["from medium: friction"] is Verdict.DIFFERS
    same_at_all_rates = verdicts(element_verdict(fitted(dilation_slope=0.0), folder))
    assert same_at_all_rates["rate jump: packing"] is not Verdict.INDISTINGUISHABLE


def with_own_answers(path, law, parameters, into):
    """The data file with the law's own answers in place of what was measured; errors and gaps stay."""
    lines = path.read_text().splitlines()
    start = next(number for number, line in enumerate(lines) if not line.startswith("#"))
    names = [name.split(" ")[0] for name in lines[start].split(",")]
    rows = [line.split(",") for line in lines[start + 1 :]]
    (data,) = read_data(path, law)
    result = ForwardModel(law, (data,)).history(data, parameters, data.abscissa)
    for measured in data.measured:
        column = names.index(measured.name)
        for row, value in zip(rows, answer(result, measured), strict=True):
            row[column] = row[column] and f"{value:.9g}"
    (into / path.name).write_text("\n".join([*lines[: start + 1], *(",".join(row) for row in rows)]) + "\n")


def test_own_answers_are_met(folder, tmp_path):
    """The law's own friction and packing in place of those of the grains; so soft that its peak lies on a row."""
    law = fitted(stiffness=4e6)
    for name in (PEAK_FILE, TRIAXIAL_FILE, *MEANS):
        with_own_answers(folder / name, get_material("mu_i_state"), law.parameters, tmp_path)
    found = element_verdict(law, tmp_path)
    errors = {one.name: abs(one.distance) for one in found.distances}
    assert len(errors) == len(START) + len(TRIAXIAL) + 2 * len(MEANS)
    assert max(errors.values()) < 1e-3
    assert [curve.test for curve in found.curves][:2] == ["from dense", "from dense"]


def test_a_test_that_cannot_be_followed_is_named(folder, tmp_path):
    for name in (FLOW_FILE, CYCLE_FILE):
        (tmp_path / name).write_text((folder / name).read_text().replace("isotropic", "isotropical"))
    found = element_verdict(fitted(), tmp_path)
    assert tuple(verdicts(found)) == ("steady friction", "steady solid fraction")
    assert "isotropical" in found.failures[0]
