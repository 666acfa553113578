"""Verdicts of validation cases: bands, orders and negative controls."""

import json
import math
from xml.etree import ElementTree

import pytest

from grainlaw.materials import SimulationError
from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Figure, curve, relative_error, upper_bound
from grainlaw.validation.report.case_content import content
from grainlaw.validation.report.case_report import write_report
from grainlaw.validation.report.junit import junit
from grainlaw.validation.report.write import as_json
from grainlaw.validation.result import run_case

WITHIN = relative_error("speed", "m/s", 1.0005, 1.0, 1e-3)
OUTSIDE = relative_error("speed", "m/s", 1.002, 1.0, 1e-3)


def case(measurements, control=(OUTSIDE,), convergence=(), figures=()):
    evidence = Evidence(tuple(measurements), tuple(convergence), tuple(figures), ("a note",))
    return Case("fall", "a fall", "gravity", "v = g t", "relative", "half of g", lambda _: evidence, lambda _: control)


def verdict(*arguments, **keywords):
    return run_case(case(*arguments, **keywords), Effort.QUICK)


def test_a_case_passes_within_its_band_if_its_control_leaves_it():
    result = verdict([WITHIN])
    assert result.passed
    assert result.reasons == ()


def test_one_measurement_outside_its_band_fails_the_case():
    result = verdict([WITHIN, OUTSIDE])
    assert not result.passed
    assert result.reasons == ("speed: error 0.002, band 0.001",)


def test_a_control_within_the_band_fails_the_case():
    result = verdict([WITHIN], control=(WITHIN,))
    assert not result.passed
    assert "half of g" in result.reasons[0]


def test_a_measurement_that_is_not_a_number_is_outside_every_band():
    assert not verdict([upper_bound("energy", "J", math.nan, 1e9)]).passed


def test_a_case_without_measurements_does_not_pass():
    assert not verdict([]).passed


def test_a_computation_that_breaks_down_fails_its_case_and_no_other():
    def broken(_):
        raise SimulationError("t = 1 s: the point has left the domain")

    whole = case([WITHIN])
    result = run_case(Case(**{**whole.__dict__, "measure": broken}), Effort.QUICK)
    assert not result.passed
    assert result.reasons == ("t = 1 s: the point has left the domain",)


def test_orders_of_errors_that_fall_with_the_square_of_the_size():
    found = Convergence("v", "cell", (0.4, 0.2, 0.1), (0.16, 0.04, 0.01), least_order=1.9)
    assert found.orders == pytest.approx([2.0, 2.0])
    assert found.fitted_order == pytest.approx(2.0)
    assert verdict([WITHIN], convergence=[found]).passed


def test_too_low_an_order_fails_the_case():
    found = Convergence("v", "cell", (0.4, 0.2, 0.1), (0.4, 0.2, 0.1), least_order=1.9)
    assert verdict([WITHIN], convergence=[found]).reasons == ("v: order 1.00, wanted 1.9",)


def test_junit_counts_failures_and_says_why():
    suite = ElementTree.fromstring(junit([verdict([WITHIN]), verdict([OUTSIDE])]))
    assert (suite.get("tests"), suite.get("failures")) == ("2", "1")
    assert "band 0.001" in suite.findall("testcase")[1].find("failure").get("message")


def test_json_holds_numbers_that_are_not_finite_as_null():
    found = as_json(content([verdict([upper_bound("energy", "J", math.nan, 1.0)])]))
    assert json.loads(found)["cases"][0]["measurements"][0]["error"] is None


def test_the_page_is_self_contained_and_names_what_failed(tmp_path):
    figure = Figure("speed", "t [s]", "v [m/s]", (curve("exact", [0, 1], [0, 1], "reference"), curve("v", [1], [1])))
    orders = Convergence("v", "cell", (0.4, 0.2), (0.16, 0.04))
    write_report(tmp_path, [verdict([OUTSIDE], figures=[figure], convergence=[orders])])
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert page.count('src="data:image/png;base64,') == 2
    assert "://" not in page
    assert "speed: error 0.002, band 0.001" in page
