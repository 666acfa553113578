"""The granular quantities that several laws share: inertial number, mu(I) and the elastic shear modulus."""

import math

from materials.pointwise import pointwise
from materials.tensor import SymmetricTensor, deviator, half_norm, pressure

# Of s n n/tau over directions n and shapes of s.
LEAST_NORMAL_SHARE = -2.0 / math.sqrt(3.0)


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
def share_after_return(
    trial_shear_stress: float,
    pressure: float,
    stiffness: float,
    static_friction: float,
    dynamic_friction: float,
    reference_rate: float,
) -> float:
    """tau/tau_trial after the return to tau_trial - stiffness x = mu(I(x)) p; one below the static yield stress [1].

    A quadratic in the plastic shear rate x >= 0 (backward Euler over a step, after Dunatunga & Kamrin 2015, J. Fluid
    Mech. 779). The stiffness [Pa s] is 2 G dt and the reference rate [1/s] that of I = I_0, I_0 sqrt(p/rho_p)/d_p.
    """
    static_stress = static_friction * pressure
    if trial_shear_stress <= static_stress:
        return 1.0
    # y^2 - b y - c = 0 for the drop y = stiffness x of the shear stress
    b = trial_shear_stress - dynamic_friction * pressure - stiffness * reference_rate
    c = stiffness * reference_rate * (trial_shear_stress - static_stress)
    root = math.sqrt(b * b + 4.0 * c)
    # Of the two forms of the root, the one that subtracts nothing.
    numerator, denominator = (b + root, 2.0) if b > 0.0 else (2.0 * c, max(root - b, 1e-300))
    return max(0.0, 1.0 - numerator / (denominator * trial_shear_stress))


@pointwise
def shear_modulus(bulk_modulus: float, poisson_ratio: float) -> float:
    """G = 3 (1 - 2 nu) / (2 (1 + nu)) K [Pa]."""
    return 1.5 * (1.0 - 2.0 * poisson_ratio) / (1.0 + poisson_ratio) * bulk_modulus


@pointwise
def longitudinal_wave_speed(bulk_modulus: float, shear_modulus: float, density: float) -> float:
    """C = sqrt((K + 4/3 G)/rho) [m/s], the fastest elastic wave."""
    return math.sqrt((bulk_modulus + 4.0 / 3.0 * shear_modulus) / density)


@pointwise
def flowing_wave_speed(
    bulk_modulus: float, shear_modulus: float, friction: float, dilatancy: float, density: float
) -> float:
    """The fastest wave [m/s] in grains that flow with tau/p = friction.

    In flow a pressure wave carries the strength along: the tangent of a Drucker-Prager flow, friction A = dtau/dp and
    dilatancy B per engineering plastic shear, has along n the modulus

        K + 4/3 G - (G x + K A) (G x + K B) / (G + A K B),   x = n s n/tau >= -2/sqrt(3),

    more than the elastic K + 4/3 G where A > B, without dilatancy by (K A)^2/(4 G) at most.
    """
    compliance = 1.0 / shear_modulus
    x = max(-0.5 * (bulk_modulus * compliance) * (friction + dilatancy), LEAST_NORMAL_SHARE)
    along = (shear_modulus * x + bulk_modulus * friction) * (shear_modulus * x + bulk_modulus * dilatancy)
    # Most laws state a dilatancy of zero, which spares their points a division.
    hardening = compliance if dilatancy == 0.0 else 1.0 / (shear_modulus + friction * bulk_modulus * dilatancy)
    elastic = bulk_modulus + 4.0 / 3.0 * shear_modulus
    return math.sqrt((elastic - min(0.0, along * hardening)) / density)


@pointwise
def stress_ratio(stress: SymmetricTensor) -> float:
    """tau/p [1], zero without stress."""
    return half_norm(deviator(stress)) / max(pressure(stress), 1e-300)


def own_inertial_number_constant(engineering_constant: float) -> float:
    """I_0 for this library from a literature I_0 that counts the engineering shear rate dv_x/dy.

    In simple shear gamma_dot is half of the engineering rate, so a constant measured against the engineering rate
    (0.279 for glass beads) is twice the constant that belongs to gamma_dot.
    """
    return 0.5 * engineering_constant
