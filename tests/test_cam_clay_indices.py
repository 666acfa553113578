"""Indices of Cam Clay measured in e - ln p, in the plane of this library."""

import math

import pytest

from grainlaw.plugins.cam_clay.indices import own_index


def test_an_index_in_e_ln_p_is_divided_by_the_specific_volume():
    assert own_index(0.09, 0.8) == pytest.approx(0.05, rel=1e-15)


def test_it_is_the_slope_of_ln_v_where_the_void_ratio_is_the_one_given():
    void_ratio, small = 0.72, 1e-6
    lower, upper = (math.log(1.0 + void_ratio - 0.161 * log_pressure) for log_pressure in (-small, small))
    assert own_index(0.161, void_ratio) == pytest.approx((lower - upper) / (2.0 * small), rel=1e-9)
