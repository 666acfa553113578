"""The page of speed against error: what errors are counted against, the front, and the square whose answer is known."""

import json
import math
from dataclasses import replace

import pytest

from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.validation.cases.speed.exact import ExactSetting, cost_and_error
from grainlaw.validation.cases.speed.front import error, mean_observables, pareto_front
from grainlaw.validation.cases.speed.setting import Outcome, Setting, as_dict
from grainlaw.validation.cases.speed.store import made_with_other_kernels, outcomes
from grainlaw.validation.cases.speed.sweep import references

OUTCOME = Outcome(points=1, steps=1, cpu_time=1.0, runout=1.0, height=0.5, center=0.2, mark="")


def test_errors_are_counted_against_a_mean_and_a_broken_run_counts_as_none():
    exact = mean_observables([OUTCOME, replace(OUTCOME, runout=1.2)])
    assert exact == {"runout": pytest.approx(1.1), "height": 0.5, "center": 0.2}
    assert error(replace(OUTCOME, runout=1.1, height=0.45), exact) == pytest.approx(0.1)
    assert math.isnan(error(None, exact))
    assert math.isnan(mean_observables([OUTCOME, None])["runout"])


def test_the_front_holds_what_nothing_cheaper_is_as_good_as():
    costs = {"cheap": (1.0, 0.3), "beaten": (2.0, 0.3), "good": (3.0, 0.1), "dear": (4.0, 0.2)}
    assert pareto_front(costs) == [("cheap", 1.0, 0.3), ("good", 3.0, 0.1)]


def test_settings_that_differ_have_files_of_their_own():
    usual = Setting("MCC OCR 1", "paper", 0.05)
    changes = ({"precision": "single"}, {"points_per_cell": 4}, {"basis": "cubic"})
    assert len({usual.key, *(replace(usual, **change).key for change in changes)}) == 4


def test_references_have_the_points_with_which_piles_of_their_law_converge():
    assert references("MCC OCR 4", "paper", ()) == []
    assert {found.points_per_cell for found in references("MCC OCR 4", "paper")} == {25}
    assert {found.points_per_cell for found in references("mu(I)-LC", "paper", (0.01, 0.005))} == {16}


def test_the_square_costs_more_and_errs_less_on_finer_cells():
    coarse, fine = (
        cost_and_error(ExactSetting(cells, 4, 0.4, "affine_flip", "quadratic", "double")) for cells in (8, 16)
    )
    assert coarse is not None
    assert fine is not None
    assert fine[1] < 0.4 * coarse[1]
    assert fine[0] > 0.0


def test_outcomes_of_other_kernels_are_counted(tmp_path):
    old, new = Setting("MCC OCR 1", "paper", 0.05), Setting("MCC OCR 1", "paper", 0.1)
    for setting, mark in ((old, "another"), (new, CORE_MARK)):
        content = as_dict(setting, replace(OUTCOME, mark=mark))
        (tmp_path / f"{setting.key}.json").write_text(json.dumps(content), encoding="utf-8")
    found = outcomes(tmp_path, [old, new])
    assert found[new] == replace(OUTCOME, mark=CORE_MARK)
    assert made_with_other_kernels([*found.values(), None]) == 1
