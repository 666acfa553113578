"""mu(I)-MCC contains both parents and cannot fail: the validation cases, in their quick form."""

import pytest

from grainlaw.validation.case import Effort
from grainlaw.validation.catalogue import get_case
from grainlaw.validation.result import run_case


@pytest.mark.parametrize(
    "name", ["mu_i_mcc_return", "mu_i_mcc_cam_clay_limit", "mu_i_mcc_steady_shear", "mu_i_mcc_rate_jump"]
)
def test_case_passes_and_its_control_does_not(name):
    result = run_case(get_case(name), Effort.QUICK)
    assert result.passed, result.reasons
