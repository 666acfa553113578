"""Elastoplastic mu(I) rheology: hypoelastic grains in contact, mu(I) plastic flow, and true separation.

    sigma_dot = K tr(D) 1 + 2 G (D_d - D^p),   G = 3 (1 - 2 nu) / (2 (1 + nu)) K             (1)
    D^p = gamma_dot^p s/tau,   tau <= mu(I) p                                                (2)
    mu(I) = mu_s + (mu_2 - mu_s) / (I_0/I + 1),   I = gamma_dot^p d_p / sqrt(p/rho_p)         (3)
    sigma = 0 where rho < rho_c                                                              (4)

Flow at constant volume leaves the trace of (1) to integrate exactly, p = K ln(rho/rho_c): contact ends, and begins
again, at the density rho_c where the pressure vanishes, so that grains may fly apart and come together without gain of
volume. rho_c follows for each point from its initial pressure and density, so that the initial state is in equilibrium;
the sets below start at the published critical density. Over a step, the plastic rate is the root of a quadratic
(`radial_return_factor`, shared with `mu_i_lc`), as in the source.

`mu_i_lc` takes the elastic predictor from the same source. The two differ in what they are made to represent: there
K_LC is the compression law of a fluid-like model, linear in density (the paper's Eq. 6); here K and nu are the
elasticity of a skeleton, and stress is the integral of a rate, logarithmic in density. To first order in p/K they are
the same law; where p is not small against K, this one is the softer.

Source: Dunatunga & Kamrin (2015), J. Fluid Mech. 779, 483-513.
Conventions: tensors tension-positive, p compression-positive; tau = sqrt(1/2 s:s), gamma_dot = sqrt(1/2 D_d:D_d), so
I_0 belongs to half of the engineering rate (`own_inertial_number_constant` converts a literature value).
Valid for dense flow, free fall and reconsolidation of stiff grains; no dilatancy, no strength in tension.
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
    energy_of_logarithmic_compression,
    energy_of_shear,
    flowing_wave_speed,
    half_norm,
    hookimpl,
    isotropic,
    not_smaller,
    pressure,
    shear_modulus,
    stress_ratio,
)
from grainlaw.plugins.mu_i.friction import own_inertial_number_constant, radial_return_factor


class Parameters(NamedTuple):
    """Material constants."""

    static_friction: Annotated[float, Parameter("1", "friction coefficient mu_s of slow flow", "[0, inf)")]
    dynamic_friction: Annotated[float, Parameter("1", "friction coefficient mu_2 of fast flow", "[0, inf)")]
    inertial_number_constant: Annotated[
        float, Parameter("1", "I_0, where mu is halfway from mu_s to mu_2; for the rate sqrt(1/2 D_d:D_d)", "(0, inf)")
    ]
    bulk_modulus: Annotated[float, Parameter("Pa", "bulk modulus K", "(0, inf)")]
    poisson_ratio: Annotated[float, Parameter("1", "Poisson's ratio nu", "(-1, 0.5)")]
    grain_density: Annotated[float, Parameter("kg/m3", "density rho_p of the grains", "(0, inf)")]
    grain_diameter: Annotated[float, Parameter("m", "diameter d_p of the grains", "(0, inf)")]


class State(NamedTuple):
    """What a point remembers."""

    critical_density: Annotated[
        float, StateVariable("kg/m3", "bulk density rho_c below which grains are apart", output=False)
    ]


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """The critical density from which (1) leads to the present pressure."""
    return State(density * math.exp(-max(0.0, pressure(stress)) / parameters.bulk_modulus))


def update(
    stress: SymmetricTensor,
    strain_rate: SymmetricTensor,
    density: float,
    state: State,
    parameters: Parameters,
    dt: float,
) -> tuple[SymmetricTensor, State]:
    """Separation, elastic predictor, return to tau = mu(I) p."""
    if density <= state.critical_density:
        return isotropic(0.0), state
    new_pressure = parameters.bulk_modulus * math.log(density / state.critical_density)

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
    return assembled_stress(new_pressure, factor * trial), state


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of longitudinal waves in flow; of an open point, at the density where it will be in contact."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    contact_density = max(density, state.critical_density)
    return flowing_wave_speed(parameters.bulk_modulus, modulus, stress_ratio(stress), 0.0, contact_density)


def stored_energy(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Exact along isotropic paths; the deviator's part to the first order in the strain of volume."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    isotropic_part = energy_of_logarithmic_compression(pressure(stress), density, parameters.bulk_modulus)
    return isotropic_part + energy_of_shear(stress, density, modulus)


def inconsistency(parameters: Parameters) -> str:
    """Friction may not fall with the shear rate: slow and fast flow would then be possible at one stress."""
    return not_smaller(parameters, "dynamic_friction", "static_friction")


def density_above_critical(mean_pressure: float, parameters: Parameters) -> float:
    """Bulk density [kg/m3] at rest, from a critical density of 1500 kg/m3."""
    return 1500.0 * math.exp(mean_pressure / parameters.bulk_modulus)


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
    name="mu_i_elastoplastic",
    summary="mu(I) rheology with hypoelastic grains and true separation (Dunatunga & Kamrin 2015)",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    inconsistency=inconsistency,
    parameter_sets={
        "glass_beads": ParameterSet(
            PAPER._replace(
                static_friction=0.3819,
                dynamic_friction=0.6435,
                inertial_number_constant=own_inertial_number_constant(0.279),
                bulk_modulus=1e6,
                poisson_ratio=0.3,
            ),
            "friction, I_0 and densities of glass beads in Dunatunga & Kamrin (2015); K and nu are choices",
            density_above_critical,
        ),
        "paper": ParameterSet(PAPER, "constants of `mu_i_lc`, Table 1 of its source", density_above_critical),
    },
    holds_in_single=True,
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
