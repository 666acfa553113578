"""mu(I)-LC rheology: mu(I) friction, linear compression, and an elastic predictor for the limit of rest.

    p      = K_LC (phi/phi_ref - 1), stress-free where phi <= phi_ref                        (paper Eq. 6)
    I      = gamma_dot^p d_p / sqrt(p/rho_p)                                                 (paper Eq. 1)
    mu(I)  = mu_0 + (mu_d - mu_0) / (I_0/I + 1)                                              (paper Eq. 2)
    s_dot  = 2 G (D_d - D^p),  D^p = gamma_dot^p s/tau,  tau <= mu(I) p                      (paper Eqs. 3-4)

The published law sets s = eta D_d, with a regularised viscosity near rest (`mu_i_lc_viscous`). Here the rate is split
into an elastic and a plastic part (Dunatunga & Kamrin 2015, J. Fluid Mech. 779), so that tau may stay below mu_0 p:
material at rest stays at rest, and alpha = 0. In steady shear the elastic rate vanishes and tau = mu(I) p exactly.

Over a step dt, with the trial stress tau_trial = |s + 2 G dt D_d|, the plastic rate x is the positive root of

    tau_trial - 2 G dt x = mu(I(x)) p,

a quadratic in x, solved in closed form (backward Euler).

Source: paper = "A comparative study of granular solid-like and fluid-like constitutive laws", EPJ
Web of Conferences 340, 02014 (2025), doi 10.1051/epjconf/202534002014, Eqs. 1-6, Table 1.
Conventions: tensors tension-positive, p compression-positive; tau = sqrt(1/2 s:s), gamma_dot = sqrt(1/2 D_d:D_d), so
I_0 belongs to half of the engineering rate (`own_inertial_number_constant` converts a literature value).
phi_ref follows for each point from its initial pressure and density, so that the initial state is in equilibrium.
Valid for dense flow at constant critical friction: no dilatancy, no memory of the packing but its density.
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
    energy_of_linear_compression,
    energy_of_shear,
    flowing_wave_speed,
    half_norm,
    hookimpl,
    not_smaller,
    pressure,
    shear_modulus,
    stress_ratio,
)
from grainlaw.plugins.mu_i.friction import radial_return_factor
from grainlaw.plugins.mu_i.resolutions import MU_I_LC


class Parameters(NamedTuple):
    """Material constants."""

    static_friction: Annotated[float, Parameter("1", "friction coefficient mu_0 of slow flow, M/sqrt(3)", "[0, inf)")]
    dynamic_friction: Annotated[
        float, Parameter("1", "friction coefficient mu_d of fast flow, M_d/sqrt(3)", "[0, inf)")
    ]
    inertial_number_constant: Annotated[
        float, Parameter("1", "I_0, where mu is halfway from mu_0 to mu_d; for the rate sqrt(1/2 D_d:D_d)", "(0, inf)")
    ]
    bulk_modulus: Annotated[float, Parameter("Pa", "bulk modulus K_LC of the linear compression law", "(0, inf)")]
    poisson_ratio: Annotated[float, Parameter("1", "Poisson's ratio nu of the elastic predictor", "(-1, 0.5)")]
    grain_density: Annotated[float, Parameter("kg/m3", "density rho_p of the grains", "(0, inf)")]
    grain_diameter: Annotated[float, Parameter("m", "diameter d_p of the grains", "(0, inf)")]


class State(NamedTuple):
    """What a point remembers."""

    reference_solid_fraction: Annotated[
        float, StateVariable("1", "solid fraction phi_ref at which the grains lose contact", output=False)
    ]


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """The reference solid fraction at which Eq. 6 returns the present pressure."""
    solid_fraction = density / parameters.grain_density
    return State(solid_fraction / (1.0 + max(0.0, pressure(stress)) / parameters.bulk_modulus))


def update(
    stress: SymmetricTensor,
    strain_rate: SymmetricTensor,
    density: float,
    state: State,
    parameters: Parameters,
    dt: float,
) -> tuple[SymmetricTensor, State]:
    """Linear compression, elastic predictor, return to tau = mu(I) p."""
    reference_density = parameters.grain_density * state.reference_solid_fraction
    new_pressure = max(0.0, parameters.bulk_modulus * (density / reference_density - 1.0))

    stiffness = 2.0 * shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio) * dt
    trial = deviator(stress) + stiffness * deviator(strain_rate)
    trial_shear_stress = half_norm(trial)
    reference_rate = math.sqrt(new_pressure / parameters.grain_density) / parameters.grain_diameter
    factor = radial_return_factor(
        trial_shear_stress,
        new_pressure,
        stiffness,
        parameters.static_friction,
        parameters.dynamic_friction,
        parameters.inertial_number_constant * reference_rate,
    )
    return assembled_stress(new_pressure, (factor if new_pressure > 0.0 else 0.0) * trial), state


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of longitudinal waves in flow; of an open point, at the density of contact.

    dp/d(ln rho) = K_LC phi/phi_ref = K_LC + p.
    """
    bulk_modulus = parameters.bulk_modulus + max(0.0, pressure(stress))
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    contact_density = max(density, parameters.grain_density * state.reference_solid_fraction)
    return flowing_wave_speed(bulk_modulus, modulus, stress_ratio(stress), 0.0, contact_density)


def stored_energy(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Exact along isotropic paths; the deviator's part to the first order in the strain of volume."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    isotropic_part = energy_of_linear_compression(pressure(stress), density, parameters.bulk_modulus)
    return isotropic_part + energy_of_shear(stress, density, modulus)


def inconsistency(parameters: Parameters) -> str:
    """Friction may not fall with the shear rate: slow and fast flow would then be possible at one stress."""
    return not_smaller(parameters, "dynamic_friction", "static_friction")


def density_of_table_1(mean_pressure: float, parameters: Parameters) -> float:
    """Bulk density [kg/m3] with Table 1's phi_ref = 1.317.

    That number is no solid fraction but 1/(v_cs (1 + p/K_LC)), with the critical-state specific volume v_cs = 0.7574 of
    the Cam Clay material at 1000 Pa; it places this law on the critical state line of Figure 1(c).
    """
    return 1.317 * parameters.grain_density * (1.0 + mean_pressure / parameters.bulk_modulus)


PAPER = Parameters(
    static_friction=1.20 / math.sqrt(3.0),
    dynamic_friction=2.16 / math.sqrt(3.0),
    inertial_number_constant=0.279,
    bulk_modulus=392e3,
    poisson_ratio=0.2,
    grain_density=2450.0,
    grain_diameter=0.005,
)

LAW = Law(
    name="mu_i_lc",
    summary="mu(I) rheology with linear compression and an elastic predictor, so that it can rest",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    inconsistency=inconsistency,
    parameter_sets={
        "paper": ParameterSet(PAPER, "Table 1; nu as for Cam Clay", density_of_table_1),
        "published_figure": ParameterSet(
            PAPER._replace(dynamic_friction=2.16 * math.sqrt(3.0), inertial_number_constant=2.0 * 0.279),
            "what the published Figure 1 was made with: mu_d = sqrt(3) M_d, and I_0 counted in the engineering rate",
            density_of_table_1,
        ),
    },
    holds_in_single=True,
    resolutions=lambda parameters: MU_I_LC,
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
