"""Cam Clay whose critical state depends on the inertial number I: its constants, and the yield surface that I makes.

    M(I) = M_csl + (M_inf - M_csl) I/(I_M + I)
    p_c/p_c0 = exp(I / (I_v (lambda - kappa)))

p_c0 is the size of the surface at rest. Source and derivation: `plugins/mu_i_mcc.py`.
"""

import math
from typing import NamedTuple

from grainlaw.materials import pointwise

# exp of this is beyond any pressure, and its square still a number.
LARGEST_EXPONENT = 300.0


class FlowingCamClay(NamedTuple):
    """M_csl, M_inf, I_M, I_v, lambda, kappa, nu [1], and of the grains rho_p [kg/m3] and d_p [m]."""

    critical_state_ratio: float
    dynamic_state_ratio: float
    friction_inertial_number: float
    dilation_inertial_number: float
    compression_index: float
    swelling_index: float
    poisson_ratio: float
    grain_density: float
    grain_diameter: float


@pointwise
def steady_stress_ratio(number: float, constants: FlowingCamClay) -> float:
    """M(I)."""
    slow = constants.critical_state_ratio
    return slow + (constants.dynamic_state_ratio - slow) * number / (constants.friction_inertial_number + number)


@pointwise
def slope_of_stress_ratio(number: float, constants: FlowingCamClay) -> float:
    """dM/dI."""
    constant = constants.friction_inertial_number
    distance = constant + number
    return (constants.dynamic_state_ratio - constants.critical_state_ratio) * constant / (distance * distance)


@pointwise
def plastic_index_of(constants: FlowingCamClay) -> float:
    """The slope of plastic compression, lambda - kappa."""
    return constants.compression_index - constants.swelling_index


@pointwise
def growth_of_surface(number: float, constants: FlowingCamClay) -> float:
    """p_c/p_c0."""
    exponent = number / (constants.dilation_inertial_number * plastic_index_of(constants))
    return math.exp(min(exponent, LARGEST_EXPONENT))


@pointwise
def growth_per_number(constants: FlowingCamClay) -> float:
    """The slope of ln(p_c/p_c0) with I, the same for all points."""
    return 1.0 / (constants.dilation_inertial_number * plastic_index_of(constants))


@pointwise
def sensitive_inertial_number(constants: FlowingCamClay) -> float:
    """The inertial number over which the surface changes by about its own size."""
    return min(constants.dilation_inertial_number * plastic_index_of(constants), constants.friction_inertial_number)
