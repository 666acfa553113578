"""Strain rates turned to the end of a step in three dimensions: as in the plane, and to second order in general."""

import numpy as np
import pytest

from grainlaw.materials import SymmetricTensor
from grainlaw.mpm_core.kernels.rotation import at_end_of_step, at_end_of_step_3d, rotated_tensor, rotation_matrix

RATE = SymmetricTensor(0.7, -0.2, 0.4, 0.3, -0.6, 0.5)
ABOUT = np.array([1.0, -2.0, 0.5])


def test_about_the_third_axis_it_is_that_of_the_plane():
    plane = SymmetricTensor(0.7, -0.2, 0.0, 0.3, 0.0, 0.0)
    turned = at_end_of_step_3d(plane, 0.0, 0.0, 0.5 * 0.02)
    assert (turned.xx, turned.yy, turned.xy) == pytest.approx(at_end_of_step(0.7, -0.2, 0.3, 0.02), rel=1e-14)
    assert (turned.zz, turned.yz, turned.xz) == (0.0, 0.0, 0.0)


def test_what_it_leaves_out_is_of_third_order():
    def error(angle):
        vector = angle * ABOUT / np.linalg.norm(ABOUT)
        exact = rotated_tensor(RATE, rotation_matrix(*vector))
        return np.abs(np.array(at_end_of_step_3d(RATE, *vector)) - np.array(exact)).max()

    assert error(0.01) < 2e-6
    assert error(0.02) / error(0.01) == pytest.approx(8.0, rel=0.02)
