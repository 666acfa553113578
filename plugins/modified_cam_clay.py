"""Modified Cam Clay (MCC), with exponential elasticity integrated exactly and an opening strain.

    F = q^2/M^2 - p (p_c - p) <= 0                                                           (paper Eq. 7)
    d(eps^p) = dLambda [3/M^2 s - (2p - p_c)/3 1], so d(eps_v^p) = dLambda (2p - p_c)         (paper Eq. 8)
    dp_c/p_c = d(eps_v^p)/(lambda - kappa),   dp/p = d(eps_v^e)/kappa                         (paper Eq. 9)
    K = p/kappa,   G = 3 (1 - 2 nu) / (2 (1 + nu)) K                                          (paper Eq. 10)

The printed Eq. 8 lacks the factor 1/3, without which it is not the gradient of F.

Over a step, p and p_c follow their exponential laws exactly; the return to F = 0 is bracketed and cannot fail
(`plugins/cam_clay/return_map.py`).

Grains carry no tension. Where the pressure would fall below `stress_free_pressure` the point opens: its stress is zero
and `opening_strain` keeps the volumetric strain since, so that pressure returns only when the point has closed.

Source: paper = "A comparative study of granular solid-like and fluid-like constitutive laws", EPJ
Web of Conferences 340, 02014 (2025), doi 10.1051/epjconf/202534002014, Eqs. 7-10, Table 1;
MCC after Roscoe & Burland (1968).
Indices: kappa and lambda are slopes in ln v - ln p; `plugins/cam_clay/indices.py` converts those of e - ln p, which are
to be divided by 1 + e.
In a scene the body needs an `initial_stress`: p_c is OCR times the surface through it, and the stiffness grows with p.
Without one, points start at the edge of contact, where they have none.
Conventions: tensors tension-positive; p, eps_v compression-positive; q = sqrt(3/2 s:s).
Valid for quasi-static deformation: the law knows no rate.
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
    pointwise,
    pressure,
    shear_modulus,
    strain_in_contact,
    volumetric_strain_rate,
)
from grainlaw.plugins.cam_clay.resolutions import MODIFIED_CAM_CLAY
from grainlaw.plugins.cam_clay.return_map import CamClay, cam_clay_step, energy_of_cam_clay, log_volume_of_figure_1
from grainlaw.plugins.cam_clay.small_step import small_step_of


class Parameters(NamedTuple):
    """Material constants."""

    critical_state_ratio: Annotated[float, Parameter("1", "slope M = q/p of the critical state line", "(0, inf)")]
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
    stress_free_pressure: Annotated[
        float, Parameter("Pa", "pressure below which grains are taken to lose contact", "(0, inf)")
    ] = 1.0


class State(NamedTuple):
    """What a point remembers."""

    preconsolidation_pressure: Annotated[float, StateVariable("Pa", "size p_c of the yield surface")]
    opening_strain: Annotated[
        float, StateVariable("1", "volumetric strain beyond the stress-free state; 0 while in contact")
    ]


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """The yield surface through the initial stress, times OCR; a stress-free point starts at the edge of contact."""
    p = max(pressure(stress), parameters.stress_free_pressure)
    q = deviatoric_stress(stress)
    m = parameters.critical_state_ratio
    through_stress = p + q * q / (m * m * p)
    return State(parameters.overconsolidation_ratio * max(through_stress, smallest_yield_surface(parameters)), 0.0)


def update(
    stress: SymmetricTensor,
    strain_rate: SymmetricTensor,
    density: float,
    state: State,
    parameters: Parameters,
    dt: float,
) -> tuple[SymmetricTensor, State]:
    """Close an opened point, then the elastic trial step, the return to F = 0, and opening."""
    strain = strain_in_contact(
        volumetric_strain_rate(strain_rate) * dt, dt * deviator(strain_rate), state.opening_strain
    )
    if strain.opening_strain > 0.0:
        return isotropic(0.0), State(state.preconsolidation_pressure, strain.opening_strain)

    new = cam_clay_step(
        max(pressure(stress), parameters.stress_free_pressure),
        deviator(stress),
        strain.compression,
        strain.shear,
        state.preconsolidation_pressure,
        constants_of(parameters),
        0.0,
    )
    smallest = parameters.stress_free_pressure
    preconsolidation_pressure = max(new.preconsolidation_pressure, smallest_yield_surface(parameters))
    if new.mean_pressure < smallest:
        opening_strain = parameters.swelling_index * math.log(smallest / new.mean_pressure)
        return isotropic(0.0), State(preconsolidation_pressure, opening_strain)
    return assembled_stress(new.mean_pressure, new.deviator), State(preconsolidation_pressure, 0.0)


@pointwise
def constants_of(parameters: Parameters) -> CamClay:
    """M, lambda, kappa and nu."""
    return CamClay(
        parameters.critical_state_ratio,
        parameters.compression_index,
        parameters.swelling_index,
        parameters.poisson_ratio,
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
    """Compression has to be softer than swelling."""
    return larger(parameters, "compression_index", "swelling_index")


def density_on_compression_line(mean_pressure: float, parameters: Parameters) -> float:
    """Bulk density [kg/m3] at rest, from isotropic compression and swelling."""
    ocr = parameters.overconsolidation_ratio
    log_volume = log_volume_of_figure_1(mean_pressure, ocr, parameters.compression_index, parameters.swelling_index)
    return parameters.grain_density / math.exp(log_volume)


PAPER = Parameters(
    critical_state_ratio=1.20,
    compression_index=0.040,
    swelling_index=0.008,
    poisson_ratio=0.2,
    overconsolidation_ratio=1.0,
    grain_density=2450.0,
)

LAW = Law(
    name="modified_cam_clay",
    summary="Modified Cam Clay critical-state plasticity with exact exponential elasticity and opening",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    lower_bounds={"preconsolidation_pressure": smallest_yield_surface},
    inconsistency=inconsistency,
    least_initial_pressure=lambda parameters: parameters.stress_free_pressure,
    small_step=small_step_of(State, constants_of),
    parameter_sets={
        "paper": ParameterSet(PAPER, "Table 1, OCR = 1", density_on_compression_line),
        "paper_ocr4": ParameterSet(
            PAPER._replace(overconsolidation_ratio=4.0), "Table 1, OCR = 4", density_on_compression_line
        ),
    },
    resolutions=lambda parameters: MODIFIED_CAM_CLAY.get(parameters.overconsolidation_ratio, {}),
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
