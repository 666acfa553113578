"""Elastic energy per mass [J/kg] of the stresses that several laws share.

The work of the stress per mass is sigma:D/rho dt. Along isotropic paths it integrates exactly, to a function of
pressure and density that is zero where p = 0. The deviator stores s:s/(4 G rho), exactly so at constant density: in a
law of rate form, sheared material whose volume changes by eps gains or loses that share of it.
"""

import math

from grainlaw.materials.pointwise import pointwise
from grainlaw.materials.tensor import SymmetricTensor, contraction, deviator


@pointwise
def energy_of_linear_compression(pressure: float, density: float, bulk_modulus: float) -> float:
    """Energy behind p = K (rho/rho_ref - 1): int p/rho^2 d(rho) from rho_ref.

    It is (K/rho) [(1 + x) ln(1 + x) - x] with x = p/K, to first order p^2/(2 K rho).
    """
    x = pressure / bulk_modulus
    return bulk_modulus / density * ((1.0 + x) * math.log1p(x) - x)


@pointwise
def energy_of_logarithmic_compression(pressure: float, density: float, bulk_modulus: float) -> float:
    """Energy behind dp = K d(eps_v), so p = K ln(rho/rho_ref): (K/rho) [exp(p/K) - 1 - p/K]."""
    x = pressure / bulk_modulus
    return bulk_modulus / density * (math.expm1(x) - x)


@pointwise
def energy_of_shear(stress: SymmetricTensor, density: float, shear_modulus: float) -> float:
    """Energy s:s/(4 G rho) of the deviator."""
    s = deviator(stress)
    return contraction(s, s) / (4.0 * shear_modulus * density)
