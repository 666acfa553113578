"""What the rehearsal of a scene says of the cost of its steps."""

import numpy as np
import pytest

from grainlaw.mpm_core.stepping.rehearsal import FIRST_STEPS, _growth

COMPILING = [5.0] * FIRST_STEPS


def test_steps_that_grow_cost_more_in_the_mean_than_at_the_start():
    durations = np.linspace(1.0, 2.0, 1000).tolist()
    assert _growth(COMPILING + durations) == pytest.approx(0.5 - 0.05, abs=0.01)


def test_a_burst_of_slow_steps_at_the_start_does_not_make_the_rest_look_cheap():
    durations = [3.0] * 40 + [1.0] * 960
    assert _growth(COMPILING + durations) == 0.0


def test_a_rehearsal_that_breaks_down_at_once_shows_no_growth():
    assert _growth(COMPILING) == 0.0
    assert _growth([*COMPILING, 1.0]) == 0.0
