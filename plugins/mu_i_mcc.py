"""mu(I)-MCC: Modified Cam Clay whose critical state depends on the inertial number; one law for solid and flow.

    (q/(M_csl p))^2 = (2 xi - 1) M_I^2,   xi = p_s/p,   p_s = p_c/2                          (1)
    M_I = 1 + (M_inf/M_csl - 1) I/(I_M + I)                                                  (2)
    v = v_csl(p_s) (p_s/p)^kappa exp(I/I_v),   v_csl = exp(Gamma) p_s^-lambda                (3)
    d(eps_v^p) = (lambda - kappa) d(ln p_s) - dI/I_v                                         (4)
    d(eps^p) = dLambda [3/M^2 s - (2p - p_c)/3 1],   M = M_csl M_I                           (5)
    I = gamma_dot^p d_p / sqrt(p/rho_p)                                                      (6)

Derivation. (1) is q^2 = M^2 p (p_c - p), the ellipse of Modified Cam Clay with the slope M(I) of (2). (3) puts the
steady state p = p_s at v_csl(p) exp(I/I_v), with swelling by kappa away from it; -d(ln v) less the elastic part
kappa d(ln p) is (4). (4) integrates, whatever the history of I, to

    p_c = p_c0 exp(I / (I_v (lambda - kappa))),   d(ln p_c0) = d(eps_v^p) / (lambda - kappa) (7)

where p_c0, the size of the surface at rest, hardens as in Cam Clay and is the state variable. Flow (5) is associated
with the surface at the present I: no volume change where 2p = p_c, which is where q/p = M(I) on (1). So steady shear is
at q/p = M(I) and v = v_csl(p) exp(I/I_v); and I_M, I_v -> infinity leave M = M_csl and p_c = p_c0: Cam Clay.
A change of the shear rate moves the surface at once, p_c0 only as volume changes: hence overshoot and dilation.
Dissipation is (p (2p - p_c) + 2 q^2/M^2) dLambda = p p_c dLambda >= 0.

A step. I is the plastic inertial number of the step, with p at its end, found together with the return to (1) between
brackets (`plugins/cam_clay/rate_dependent_return_map.py`); (2) and (7) are in `plugins/cam_clay/rate_dependent.py`.

Grains carry no tension: opened points keep an opening strain, as in `modified_cam_clay`.

Source: (1)-(4) as published with the HydraxMPM code, Lubbe et al. (2026), and the idea of mu(I)-MCC in Blatny et al.
(2024); flow rule, (7) and integration are this project's.
Indices and `initial_stress`: as `modified_cam_clay`.
Conventions: tensors tension-positive; p, eps_v compression-positive; q = sqrt(3/2 s:s); gamma_dot = sqrt(1/2 D_d:D_d),
so I_M and I_v belong to half of the engineering rate (`own_inertial_number_constant` converts literature values).
Valid from rest to dense flow, I below 1; beyond, collisions carry stress that (3) does not know.
"""

import math
from typing import Annotated, Any, NamedTuple

from grainlaw.materials import (
    Law,
    Parameter,
    ParameterSet,
    StateVariable,
    SymmetricTensor,
    assembled_stress,
    deviator,
    deviatoric_stress,
    hookimpl,
    isotropic,
    larger,
    longitudinal_wave_speed,
    not_smaller,
    pointwise,
    pressure,
    shear_modulus,
    strain_in_contact,
    volumetric_strain_rate,
)
from grainlaw.plugins.cam_clay.rate_dependent import FlowingCamClay, growth_of_surface
from grainlaw.plugins.cam_clay.rate_dependent_return_map import flowing_cam_clay_step
from grainlaw.plugins.cam_clay.rate_dependent_small_step import small_flowing_step_of
from grainlaw.plugins.cam_clay.return_map import energy_of_cam_clay, log_volume_of_figure_1
from grainlaw.plugins.mu_i.friction import own_inertial_number_constant


class Parameters(NamedTuple):
    """Material constants."""

    critical_state_ratio: Annotated[float, Parameter("1", "slope M_csl = q/p of slow steady shear", "(0, inf)")]
    dynamic_state_ratio: Annotated[float, Parameter("1", "slope M_inf = q/p of fast steady shear", "(0, inf)")]
    friction_inertial_number: Annotated[
        float, Parameter("1", "I_M, where q/p is halfway from M_csl to M_inf; for sqrt(1/2 D_d:D_d)", "(0, inf)")
    ]
    dilation_inertial_number: Annotated[
        float,
        Parameter("1", "I_v, over which the steady specific volume grows by e; for sqrt(1/2 D_d:D_d)", "(0, inf)"),
    ]
    compression_index: Annotated[
        float, Parameter("1", "slope lambda of isotropic compression in ln v - ln p; larger than kappa", "(0, inf)")
    ]
    swelling_index: Annotated[float, Parameter("1", "slope kappa of swelling in ln v - ln p", "(0, inf)")]
    poisson_ratio: Annotated[float, Parameter("1", "Poisson's ratio nu", "(-1, 0.5)")]
    overconsolidation_ratio: Annotated[
        float,
        Parameter("1", "OCR: size of the initial yield surface over the one through the initial stress", "[1, inf)"),
    ]
    grain_density: Annotated[float, Parameter("kg/m3", "density rho_p of the grains", "(0, inf)")]
    grain_diameter: Annotated[float, Parameter("m", "diameter d_p of the grains", "(0, inf)")]
    stress_free_pressure: Annotated[
        float, Parameter("Pa", "pressure below which grains are taken to lose contact", "(0, inf)")
    ] = 1.0


class State(NamedTuple):
    """What a point remembers."""

    preconsolidation_pressure: Annotated[float, StateVariable("Pa", "size p_c0 of the yield surface at rest")]
    opening_strain: Annotated[
        float, StateVariable("1", "volumetric strain beyond the stress-free state; 0 while in contact")
    ]
    inertial_number: Annotated[float, StateVariable("1", "plastic inertial number I of the last step")]


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """At rest: the yield surface through the initial stress, times OCR; without stress, at the edge of contact."""
    p = max(pressure(stress), parameters.stress_free_pressure)
    ratio = deviatoric_stress(stress) / (parameters.critical_state_ratio * p)
    through_stress = max(p * (1.0 + ratio * ratio), smallest_yield_surface(parameters))
    return State(parameters.overconsolidation_ratio * through_stress, 0.0, 0.0)


def update(
    stress: SymmetricTensor,
    strain_rate: SymmetricTensor,
    density: float,
    state: State,
    parameters: Parameters,
    dt: float,
) -> tuple[SymmetricTensor, State]:
    """Close an opened point, then the step with its own inertial number, and opening."""
    strain = strain_in_contact(
        volumetric_strain_rate(strain_rate) * dt, dt * deviator(strain_rate), state.opening_strain
    )
    if strain.opening_strain > 0.0:
        return isotropic(0.0), State(state.preconsolidation_pressure, strain.opening_strain, 0.0)

    smallest = parameters.stress_free_pressure
    constants = constants_of(parameters)
    step = flowing_cam_clay_step(
        max(pressure(stress), smallest),
        deviator(stress),
        strain.compression,
        strain.shear,
        state.preconsolidation_pressure,
        state.inertial_number,
        dt,
        constants,
    )
    smallest_size = smallest_yield_surface(parameters) / growth_of_surface(step.surface_inertial_number, constants)
    size_at_rest = max(step.size_at_rest, smallest_size)
    if step.mean_pressure < smallest:
        opening_strain = parameters.swelling_index * math.log(smallest / step.mean_pressure)
        return isotropic(0.0), State(size_at_rest, opening_strain, 0.0)
    return assembled_stress(step.mean_pressure, step.deviator), State(size_at_rest, 0.0, step.inertial_number)


@pointwise
def constants_of(parameters: Parameters) -> FlowingCamClay:
    """The constants of the return map."""
    return FlowingCamClay(
        parameters.critical_state_ratio,
        parameters.dynamic_state_ratio,
        parameters.friction_inertial_number,
        parameters.dilation_inertial_number,
        parameters.compression_index,
        parameters.swelling_index,
        parameters.poisson_ratio,
        parameters.grain_density,
        parameters.grain_diameter,
    )


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of longitudinal elastic waves at the present pressure; zero where the point is open."""
    bulk_modulus = max(0.0, pressure(stress)) / parameters.swelling_index
    return longitudinal_wave_speed(bulk_modulus, shear_modulus(bulk_modulus, parameters.poisson_ratio), density)


def stored_energy(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Exact along isotropic paths; see `energy_of_cam_clay` for the deviator."""
    return energy_of_cam_clay(
        stress, density, parameters.swelling_index, parameters.poisson_ratio, parameters.stress_free_pressure
    )


@pointwise
def smallest_yield_surface(parameters: Parameters) -> float:
    """2 `stress_free_pressure`, where the critical state is at the edge of contact."""
    return 2.0 * parameters.stress_free_pressure


def inconsistency(parameters: Parameters) -> str:
    """Compression has to be softer than swelling, and friction may not fall with the shear rate."""
    return larger(parameters, "compression_index", "swelling_index") or not_smaller(
        parameters, "dynamic_state_ratio", "critical_state_ratio"
    )


def density_on_compression_line(mean_pressure: float, parameters: Parameters) -> float:
    """Bulk density [kg/m3] at rest, on the lines of `modified_cam_clay`."""
    ocr = parameters.overconsolidation_ratio
    log_volume = log_volume_of_figure_1(mean_pressure, ocr, parameters.compression_index, parameters.swelling_index)
    return parameters.grain_density / math.exp(log_volume)


PAPER = Parameters(
    critical_state_ratio=1.20,
    dynamic_state_ratio=2.16,
    friction_inertial_number=0.279,
    dilation_inertial_number=own_inertial_number_constant(0.5434 / 0.115),
    compression_index=0.040,
    swelling_index=0.008,
    poisson_ratio=0.2,
    overconsolidation_ratio=1.0,
    grain_density=2450.0,
    grain_diameter=0.005,
)
SOURCE = (
    "Table 1 of the paper behind both parents, I_M = I_0; I_v from sheared discrete elements, phi = 0.5434 - 0.115 I"
)

LAW = Law(
    name="mu_i_mcc",
    summary="mu(I)-MCC, the unified law: Cam Clay with an inertial-number-dependent critical state",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    lower_bounds={"preconsolidation_pressure": smallest_yield_surface},
    inconsistency=inconsistency,
    least_initial_pressure=lambda parameters: parameters.stress_free_pressure,
    small_step=small_flowing_step_of(State, constants_of),
    parameter_sets={
        "paper": ParameterSet(PAPER, f"{SOURCE}; OCR = 1", density_on_compression_line),
        "paper_ocr4": ParameterSet(
            PAPER._replace(overconsolidation_ratio=4.0), f"{SOURCE}; OCR = 4", density_on_compression_line
        ),
    },
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
