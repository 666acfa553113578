"""The granular quantities that several laws share: inertial number, mu(I) and the elastic shear modulus."""

import math

from materials.pointwise import pointwise


@pointwise
def inertial_number(shear_rate: float, pressure: float, grain_diameter: float, grain_density: float) -> float:
    """I = gamma_dot d_p / sqrt(p/rho_p) (paper Eq. 1), in the rate invariant gamma_dot = sqrt(1/2 D_d:D_d)."""
    return shear_rate * grain_diameter / math.sqrt(pressure / grain_density)


@pointwise
def friction_of_inertial_number(
    inertial_number: float, static_friction: float, dynamic_friction: float, inertial_number_constant: float
) -> float:
    """mu(I) = mu_0 + (mu_d - mu_0) / (I_0/I + 1) (paper Eq. 2), finite at I = 0."""
    saturation = inertial_number / (inertial_number + inertial_number_constant)
    return static_friction + (dynamic_friction - static_friction) * saturation


@pointwise
def shear_modulus(bulk_modulus: float, poisson_ratio: float) -> float:
    """G = 3 (1 - 2 nu) / (2 (1 + nu)) K [Pa]."""
    return 1.5 * (1.0 - 2.0 * poisson_ratio) / (1.0 + poisson_ratio) * bulk_modulus


@pointwise
def longitudinal_wave_speed(bulk_modulus: float, shear_modulus: float, density: float) -> float:
    """C = sqrt((K + 4/3 G)/rho) [m/s], the fastest elastic wave."""
    return math.sqrt((bulk_modulus + 4.0 / 3.0 * shear_modulus) / density)


def own_inertial_number_constant(engineering_constant: float) -> float:
    """I_0 for this library from a literature I_0 that counts the engineering shear rate dv_x/dy.

    In simple shear gamma_dot is half of the engineering rate, so a constant measured against the engineering rate
    (0.279 for glass beads) is twice the constant that belongs to gamma_dot.
    """
    return 0.5 * engineering_constant
