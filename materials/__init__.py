"""What a constitutive law is: declarations, registry, tensor algebra, compilation and element tests."""

from materials.cam_clay import CamClay, CamClayStep, cam_clay_step, energy_of_cam_clay, log_volume_of_figure_1
from materials.cam_clay_small_step import SmallStep, cam_clay_small_step
from materials.declarations import Parameter, StateVariable, checked_parameters
from materials.elastic_energy import (
    energy_of_linear_compression,
    energy_of_logarithmic_compression,
    energy_of_shear,
)
from materials.errors import InputError, SimulationError
from materials.flowing_cam_clay import FlowingCamClay, growth_of_surface
from materials.flowing_cam_clay_small_step import SmallFlowingStep, flowing_cam_clay_small_step
from materials.flowing_cam_clay_step import FlowingStep, flowing_cam_clay_step
from materials.gap import Contact, after_closing
from materials.law import HOOK_VERSION, Law, ParameterSet
from materials.pointwise import pointwise
from materials.registry import get_material, hookimpl, registry
from materials.rheology import (
    flowing_wave_speed,
    friction_of_inertial_number,
    inertial_number,
    longitudinal_wave_speed,
    own_inertial_number_constant,
    share_after_return,
    shear_modulus,
    stress_ratio,
)
from materials.tensor import (
    SymmetricTensor,
    added,
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
    scaled,
    shear_strain_rate,
    trace,
    volumetric_strain_rate,
)

__all__ = [
    "HOOK_VERSION",
    "CamClay",
    "CamClayStep",
    "Contact",
    "FlowingCamClay",
    "FlowingStep",
    "InputError",
    "Law",
    "Parameter",
    "ParameterSet",
    "SimulationError",
    "SmallFlowingStep",
    "SmallStep",
    "StateVariable",
    "SymmetricTensor",
    "added",
    "after_closing",
    "assembled_stress",
    "cam_clay_small_step",
    "cam_clay_step",
    "checked_parameters",
    "congruent",
    "contraction",
    "determinant",
    "deviator",
    "deviatoric_stress",
    "energy_of_cam_clay",
    "energy_of_linear_compression",
    "energy_of_logarithmic_compression",
    "energy_of_shear",
    "equivalent_shear_stress",
    "flowing_cam_clay_small_step",
    "flowing_cam_clay_step",
    "flowing_wave_speed",
    "friction_of_inertial_number",
    "get_material",
    "growth_of_surface",
    "half_norm",
    "hookimpl",
    "inertial_number",
    "isotropic",
    "log_volume_of_figure_1",
    "longitudinal_wave_speed",
    "own_inertial_number_constant",
    "pointwise",
    "pressure",
    "registry",
    "scaled",
    "share_after_return",
    "shear_modulus",
    "shear_strain_rate",
    "stress_ratio",
    "trace",
    "volumetric_strain_rate",
]
