"""The shape of a pile, measured on points placed by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from grainlaw.mpm_core.output.observables import Measure, pile_shape
from grainlaw.mpm_core.space import PLANE_STRAIN


def body(x, y, point_mass=2.0, density=1000.0):
    places = np.array([x, y], dtype=float)
    masses = np.full(places.shape[1], point_mass)
    count = len(masses)
    return SimpleNamespace(positions=places, count=count, masses=masses, initial_density=density, space=PLANE_STRAIN)


def evenly(count, width=1.0, height=0.5, **keywords):
    """Points in a row from 0 to `width`, their heights rising from 0 to `height`."""
    share = (np.arange(count) + 0.5) / count
    return body(width * share, height * share, **keywords)


CELL = 0.1  # 10 kg/m of material, 5 points of 2 kg/m
MEASURE = Measure(0.0, CELL)


def test_the_fronts_leave_one_percent_of_the_mass_on_either_side():
    shape = pile_shape([evenly(10_000)], MEASURE)
    assert (shape.front_left, shape.front_right) == pytest.approx((0.01, 0.99), abs=2e-4)
    assert shape.runout == pytest.approx(0.49, abs=2e-4)


def test_points_that_roll_ahead_do_not_move_the_front():
    pile = evenly(1000)
    ahead = body([7.0, 8.0, 9.0], [0.0, 0.0, 0.0])
    assert pile_shape([pile, ahead], MEASURE).front_right < 1.0
    assert pile_shape([pile, ahead], MEASURE).front_right == pytest.approx(0.993, abs=2e-3)


def test_the_height_is_the_level_above_which_lies_a_cell_of_material():
    levels = np.arange(100.0)
    shape = pile_shape([body(np.zeros(100), levels)], MEASURE)
    # Five points make a cell: those at 95 to 99.
    assert shape.height == 95.0
    assert shape.center_of_mass_height == pytest.approx(49.5)


def test_heights_count_from_the_floor():
    at_zero, raised = (pile_shape([evenly(500)], Measure(floor, CELL)) for floor in (0.0, -0.25))
    assert raised.height == pytest.approx(at_zero.height + 0.25)
    assert raised.center_of_mass_height == pytest.approx(at_zero.center_of_mass_height + 0.25)
    assert raised.runout == at_zero.runout


def test_bodies_count_by_their_mass():
    light = body(np.full(50, 0.0), np.full(50, 0.0), point_mass=1.0)
    heavy = body(np.full(50, 1.0), np.full(50, 1.0), point_mass=3.0)
    assert pile_shape([light, heavy], MEASURE).center_of_mass_height == pytest.approx(0.75)


def test_the_order_of_points_does_not_matter():
    order = np.random.default_rng(6).permutation(2000)
    ordered = evenly(2000)
    shuffled = body(*ordered.positions[:, order])
    first, second = (pile_shape([one], MEASURE) for one in (ordered, shuffled))
    assert first.runout == second.runout
    assert first.height == second.height


def test_a_single_point_is_a_pile():
    shape = pile_shape([body([0.3], [0.2])], MEASURE)
    assert (shape.runout, shape.height, shape.center_of_mass_height) == (0.0, 0.2, 0.2)
