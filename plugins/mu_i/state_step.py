"""A step of mu(I), state: its end if its inertial number I is assumed, and the I that is consistent with it.

The equations, (1) to (8), are in `plugins/mu_i_state.py`. Given I, backward Euler makes (1) with (4) a quadratic in z
with one positive root, however large the step.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

from grainlaw.materials import pointwise
from grainlaw.plugins.mu_i.consistent_flow import Flow, consistent_flow_of
from grainlaw.plugins.mu_i.friction import friction_of_inertial_number

if TYPE_CHECKING:
    from grainlaw.plugins.mu_i_state import Parameters

# Of the trial stress.
TOLERANCE = 1e-11


class Increment(NamedTuple):
    """A step in contact: what is known before I is.

    compression     phi/phi_j - 1
    reference_strain  z at which G rho is that of before the step
    consolidation   z_m before the step
    excess_at_rest  phi_l - phi_s, with the friction before the step
    shear_per_number  plastic shear over I z
    trial_shear_stress, stiffness  tau without plastic shear, and what plastic shear takes of it, at the last G [Pa]
    """

    solid_fraction: float
    compression: float
    reference_strain: float
    consolidation: float
    excess_at_rest: float
    shear_per_number: float
    trial_shear_stress: float
    stiffness: float


@pointwise
def unused_friction(shear_stress: float, mean_pressure: float, number: float, parameters: "Parameters") -> float:
    """<1 - tau/(mu p)> of (5)."""
    strength = mean_pressure * friction(number, parameters)
    return 1.0 - shear_stress / strength if shear_stress < strength else 0.0


@pointwise
def friction(number: float, parameters: "Parameters") -> float:
    """mu(I) of (2)."""
    return friction_of_inertial_number(
        number, parameters.static_friction, parameters.dynamic_friction, parameters.inertial_number_constant
    )


@pointwise
def flow_at(number: float, increment: Increment, parameters: "Parameters") -> Flow:
    """The end of the step if its inertial number is this one.

    With phi_j = phi (1 - z) at the end, (4) is  A z^2 + B z - C = 0,  A, C >= 0. Its left side grows with z beyond its
    root: settling and first compression act at the end if it is negative where they begin.
    """
    phi, b, end = increment.solid_fraction, parameters.compaction, increment.consolidation
    steady = max(
        parameters.critical_solid_fraction - parameters.dilation_slope * number, parameters.loosest_solid_fraction
    )
    # phi_j - phi_s (1 + b z) = dense - slope z.
    dense, slope = phi - steady, phi + b * steady
    loosening = 2.0 * parameters.dilatancy_coefficient * number * increment.shear_per_number
    A, B, C = loosening * slope, 1.0 + increment.compression - loosening * dense, increment.compression
    too_dense, slope_at_rest = dense - increment.excess_at_rest, slope + b * increment.excess_at_rest
    onset = max(0.0, too_dense)
    if slope_at_rest * (C * slope_at_rest - B * onset - b * max(0.0, onset - slope_at_rest * end)) > A * onset * onset:
        settling = parameters.settling_rate * increment.shear_per_number
        A, B = A + settling * slope_at_rest, B - settling * too_dense
    if C - end * (B + end * A) > 0.0:
        B, C = B + b, C + b * end
    root = math.sqrt(B * B + 4.0 * A * C)
    # Of the two forms of the root, the one that subtracts nothing.
    z = (root - B) / (2.0 * A) if B < 0.0 else 2.0 * C / (B + root)
    psi = parameters.dilatancy_coefficient * (dense - slope * z)
    mu = friction(number, parameters)
    strength_over_z = (
        max(mu + (1.0 - parameters.hidden_dilatancy) * psi, (1.0 + z) * psi, 0.0) * parameters.stiffness * z
    )
    # The last term of (6) multiplies the shear stress by 2 z/(z + reference_strain), to second order.
    used = increment.stiffness * number * z + 0.5 * (z + increment.reference_strain) * strength_over_z
    return Flow(number, z, strength_over_z * z, increment.trial_shear_stress - used)


flow_of_step = consistent_flow_of(flow_at, TOLERANCE)
