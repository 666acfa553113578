"""Declarations: intervals, units, and parameter values checked against them."""

import math
from typing import Annotated, NamedTuple

import pytest

from grainlaw.materials import InputError, Parameter, StateVariable, checked_parameters
from grainlaw.materials.declarations import DeclarationError, Interval, declared_fields


class Values(NamedTuple):
    stiffness: Annotated[float, Parameter("Pa", "stiffness", "(0, inf)")]
    ratio: Annotated[float, Parameter("1", "ratio", "[0, 0.5)")]
    cohesion: Annotated[float, Parameter("Pa", "cohesion", "[0, inf)")] = 0.0


@pytest.mark.parametrize(
    ("text", "inside", "outside"),
    [
        ("(0, inf)", [1e-300, 1e300], [0.0, -1.0, math.inf, math.nan]),
        ("[0, 0.5)", [0.0, 0.4999], [0.5, -1e-9, math.nan]),
        ("[-1, 1]", [-1.0, 1.0], [1.0000001, -math.inf]),
    ],
)
def test_interval_contains(text, inside, outside):
    interval = Interval.parse(text)
    assert all(interval.contains(value) for value in inside)
    assert not any(interval.contains(value) for value in outside)


@pytest.mark.parametrize("text", ["", "0, 1", "(0; 1)", "(0, 1, 2)"])
def test_text_that_is_no_interval_is_refused(text):
    with pytest.raises(DeclarationError, match="are no interval"):
        Interval.parse(text)


@pytest.mark.parametrize("unit", ["Pa", "kg/m3", "Pa.s", "1/s", "1", "m/s2"])
def test_si_units_are_taken(unit):
    class Fields(NamedTuple):
        x: Annotated[float, StateVariable(unit, "a quantity")]

    assert declared_fields(Fields, StateVariable)["x"].unit == unit


@pytest.mark.parametrize("unit", ["kPa", "mm", "psi", "kg / m3", "s^-1", ""])
def test_other_units_are_refused(unit):
    class Fields(NamedTuple):
        x: Annotated[float, StateVariable(unit, "a quantity")]

    with pytest.raises(DeclarationError, match="'x' declares"):
        declared_fields(Fields, StateVariable)


def test_values_are_completed_with_defaults_and_become_floats():
    values = checked_parameters("spring", Values, {"stiffness": 1000, "ratio": 0.2})
    assert values == Values(1000.0, 0.2, 0.0)
    assert isinstance(values.stiffness, float)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"stiffness": 1.0, "ratio": 0.2, "stifness": 2.0}, "no parameter 'stifness'; did you mean 'stiffness'"),
        ({"ratio": 0.2}, r"needs a value for: stiffness \[Pa\]"),
        ({"stiffness": 1.0, "ratio": 0.5}, r"ratio = 0.5 is out of bounds; allowed: \[0, 0.5\)"),
        ({"stiffness": "1", "ratio": 0.2}, "stiffness = '1' is not a number"),
        ({"stiffness": True, "ratio": 0.2}, "stiffness = True is not a number"),
        ({"stiffness": math.nan, "ratio": 0.2}, "stiffness = nan is out of bounds"),
    ],
)
def test_wrong_values_are_refused(values, message):
    with pytest.raises(InputError, match=message):
        checked_parameters("spring", Values, values)
