"""The granular quantities that several laws share: inertial number, mu(I) and the elastic shear modulus."""

import math

from grainlaw.materials.pointwise import pointwise
from grainlaw.materials.tensor import SymmetricTensor, deviator, half_norm, pressure

# Of s n n/tau over directions n and shapes of s.
LEAST_NORMAL_SHARE = -2.0 / math.sqrt(3.0)


@pointwise
def inertial_number(shear_rate: float, pressure: float, grain_diameter: float, grain_density: float) -> float:
    """I = gamma_dot d_p / sqrt(p/rho_p) (paper Eq. 1), in the rate invariant gamma_dot = sqrt(1/2 D_d:D_d)."""
    return shear_rate * grain_diameter / math.sqrt(pressure / grain_density)


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
