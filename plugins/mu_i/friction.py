"""The friction mu(I), the return to it, and its constant in the two ways in which shear rates are counted."""

import math

from grainlaw.materials import pointwise


@pointwise
def friction_of_inertial_number(
    inertial_number: float, static_friction: float, dynamic_friction: float, inertial_number_constant: float
) -> float:
    """mu(I) = mu_0 + (mu_d - mu_0) / (I_0/I + 1) (paper Eq. 2), finite at I = 0."""
    saturation = inertial_number / (inertial_number + inertial_number_constant)
    return static_friction + (dynamic_friction - static_friction) * saturation


@pointwise
def radial_return_factor(
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


def own_inertial_number_constant(engineering_constant: float) -> float:
    """I_0 for this library from a literature I_0 that counts the engineering shear rate dv_x/dy.

    In simple shear gamma_dot is half of the engineering rate, so a constant measured against the engineering rate
    (0.279 for glass beads) is twice the constant that belongs to gamma_dot.
    """
    return 0.5 * engineering_constant
