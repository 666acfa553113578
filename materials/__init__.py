"""What a constitutive law is: declarations, registry, tensor algebra, compilation and element tests."""

if __name__ == "materials":
    raise ImportError("import grainlaw.materials, not materials")

from grainlaw.materials.declarations import Parameter, StateVariable, checked_parameters
from grainlaw.materials.elastic_energy import (
    energy_of_linear_compression,
    energy_of_logarithmic_compression,
    energy_of_shear,
)
from grainlaw.materials.errors import InputError, SimulationError
from grainlaw.materials.law import HOOK_VERSION, Law, ParameterSet
from grainlaw.materials.opening import StrainInContact, strain_in_contact
from grainlaw.materials.order import larger, not_larger, not_smaller
from grainlaw.materials.pointwise import pointwise
from grainlaw.materials.registry import get_material, hookimpl, registry
from grainlaw.materials.resolution import Resolution
from grainlaw.materials.rheology import (
    flowing_wave_speed,
    inertial_number,
    longitudinal_wave_speed,
    shear_modulus,
    stress_ratio,
)
from grainlaw.materials.tensor import (
    SymmetricTensor,
    assembled_stress,
    congruent,
    contraction,
    determinant,
    deviator,
    deviatoric_stress,
    equivalent_shear_stress,
    half_norm,
    isotropic,
    pressure,
    shear_strain_rate,
    trace,
    volumetric_strain_rate,
)

__all__ = [
    "HOOK_VERSION",
    "InputError",
    "Law",
    "Parameter",
    "ParameterSet",
    "Resolution",
    "SimulationError",
    "StateVariable",
    "StrainInContact",
    "SymmetricTensor",
    "assembled_stress",
    "checked_parameters",
    "congruent",
    "contraction",
    "determinant",
    "deviator",
    "deviatoric_stress",
    "energy_of_linear_compression",
    "energy_of_logarithmic_compression",
    "energy_of_shear",
    "equivalent_shear_stress",
    "flowing_wave_speed",
    "get_material",
    "half_norm",
    "hookimpl",
    "inertial_number",
    "isotropic",
    "larger",
    "longitudinal_wave_speed",
    "not_larger",
    "not_smaller",
    "pointwise",
    "pressure",
    "registry",
    "shear_modulus",
    "shear_strain_rate",
    "strain_in_contact",
    "stress_ratio",
    "trace",
    "volumetric_strain_rate",
]
