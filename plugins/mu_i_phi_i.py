"""mu(I), phi(I): friction and packing that follow the inertial number, the packing with the delay of shear.

    p       = K (phi/phi_j - 1), stress-free where phi <= phi_j                              (1)
    mu(I)   = mu_0 + (mu_d - mu_0) / (I_0/I + 1),   phi_eq(I) = max(phi_0 - chi I, phi_min)   (2)
    psi     = a (phi - phi_eq(I))                                                            (3)
    d(ln phi_j)/dt = -2 psi gamma_dot^p                                                      (4)
    s_dot   = 2 G (D_d - D^p),   D^p = gamma_dot^p s/tau,   tau <= (mu(I) + psi) p           (5)
    I       = gamma_dot^p d_p / sqrt(p/rho_p)                                                (6)

phi_j is the packing at which contact is lost. Shear dilates what is denser than phi_eq, by psi per engineering strain
(twice gamma_dot), and compacts what is looser, until phi = phi_eq(I); where volume cannot change, p does, until the
same holds. Dilating against p takes work, which is why psi adds to the friction (5): what is left of the power
2 tau gamma_dot^p is 2 mu(I) p gamma_dot^p >= 0.

Which closure. With phi_eq at once in place of (3) and (4), mu(I)-phi(I) is ill-posed where volume changes cost nothing.
It is well-posed with a bulk friction above 1 - 7 mu/6 (Heyman et al. 2017). Here a rate of volume change d at the shear
rate gamma_dot moves the pressure by -d/(gamma_dot a chi I) of itself, a bulk friction of about 1/(a chi I), above 10
for the sets below at I = 0.1: the delay regularises them, and elasticity (1) bounds the rest.

Over a step I is the unknown, found in a bracket (`plugins/mu_i/consistent_flow.py`). Given I, psi is known and (1) with
(4) is a quadratic in sqrt(p). Looser than phi_min, compaction can take the pressure faster than any I p^(1/2) uses up
the trial shear; then there is no root, and the grains part: p = 0, phi_j = phi. Open points neither flow nor dilate:
phi_j stays, and they close where they opened. A root that is not found makes the stress NaN.

Source: dilatancy (3) after Roux & Radjai (1998) and Pailha & Pouliquen (2009), J. Fluid Mech. 633, a = 4.09 there;
phi(I) as in Forterre & Pouliquen (2008); well-posedness: Heyman, Delannay, Tabuteau & Valance (2017), J. Fluid Mech.
830.
Conventions: tensors tension-positive, p compression-positive; tau = sqrt(1/2 s:s), gamma_dot = sqrt(1/2 D_d:D_d), so
I_0 and 1/chi belong to half of the engineering rate.
Valid for dense flow of stiff grains, I below 0.5; pressure from collisions below phi_min is not there.
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
    isotropic,
    not_larger,
    not_smaller,
    pointwise,
    pressure,
    shear_modulus,
    stress_ratio,
)
from grainlaw.plugins.mu_i.consistent_flow import Flow, consistent_flow_of
from grainlaw.plugins.mu_i.friction import friction_of_inertial_number, own_inertial_number_constant

# Of the trial stress.
TOLERANCE = 1e-12


class Parameters(NamedTuple):
    """Material constants."""

    static_friction: Annotated[float, Parameter("1", "friction coefficient mu_0 of slow flow", "[0, inf)")]
    dynamic_friction: Annotated[float, Parameter("1", "friction coefficient mu_d of fast flow", "[0, inf)")]
    inertial_number_constant: Annotated[
        float, Parameter("1", "I_0, where mu is halfway from mu_0 to mu_d; for the rate sqrt(1/2 D_d:D_d)", "(0, inf)")
    ]
    critical_solid_fraction: Annotated[float, Parameter("1", "solid fraction phi_0 of slow flow", "(0, 1)")]
    dilation_slope: Annotated[
        float, Parameter("1", "chi, loss of solid fraction per I; for the rate sqrt(1/2 D_d:D_d)", "[0, inf)")
    ]
    loosest_solid_fraction: Annotated[float, Parameter("1", "smallest solid fraction phi_min of flow", "(0, 1)")]
    dilatancy_coefficient: Annotated[
        float, Parameter("1", "a, dilatancy per excess of solid fraction over that of steady flow", "[0, inf)")
    ]
    bulk_modulus: Annotated[float, Parameter("Pa", "bulk modulus K", "(0, inf)")]
    poisson_ratio: Annotated[float, Parameter("1", "Poisson's ratio nu", "(-1, 0.5)")]
    grain_density: Annotated[float, Parameter("kg/m3", "density rho_p of the grains", "(0, inf)")]
    grain_diameter: Annotated[float, Parameter("m", "diameter d_p of the grains", "(0, inf)")]


class State(NamedTuple):
    """What a point remembers."""

    jamming_solid_fraction: Annotated[
        float, StateVariable("1", "solid fraction phi_j at which the grains lose contact", output=False)
    ]
    inertial_number: Annotated[float, StateVariable("1", "plastic inertial number I of the last step")]


class Increment(NamedTuple):
    """A step in contact: what is known before I is."""

    compression: float
    solid_fraction: float
    trial_shear_stress: float
    stiffness: float
    dt: float


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """At rest, with the packing at which (1) returns the present pressure."""
    solid_fraction = density / parameters.grain_density
    return State(solid_fraction / (1.0 + max(0.0, pressure(stress)) / parameters.bulk_modulus), 0.0)


def update(
    stress: SymmetricTensor,
    strain_rate: SymmetricTensor,
    density: float,
    state: State,
    parameters: Parameters,
    dt: float,
) -> tuple[SymmetricTensor, State]:
    """Elastic predictor, then friction and dilatancy at the inertial number of the step."""
    solid_fraction = density / parameters.grain_density
    compression = solid_fraction / state.jamming_solid_fraction - 1.0
    if compression <= 0.0:
        return isotropic(0.0), State(state.jamming_solid_fraction, 0.0)

    stiffness = 2.0 * shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio) * dt
    trial = deviator(stress) + stiffness * deviator(strain_rate)
    trial_shear_stress = half_norm(trial)
    increment = Increment(compression, solid_fraction, trial_shear_stress, stiffness, dt)
    flow = flow_of_step(increment, state.inertial_number, parameters)
    new_pressure = flow.contact
    if new_pressure == 0.0:
        return isotropic(0.0), State(solid_fraction, 0.0)
    jamming = solid_fraction / (1.0 + new_pressure / parameters.bulk_modulus)
    if flow.number == 0.0:
        return assembled_stress(new_pressure, trial), State(state.jamming_solid_fraction, 0.0)
    factor = flow.strength / trial_shear_stress
    return assembled_stress(new_pressure, factor * trial), State(jamming, flow.number)


@pointwise
def flow_at(number: float, increment: Increment, parameters: Parameters) -> Flow:
    """The end of the step if its inertial number is this one.

    With y = sqrt(p) and the plastic rate x = I y/(d_p sqrt(rho_p)), (1) and (4) to first order in the dilation of the
    step are y^2 - b y - K (phi/phi_j - 1) = 0, b = 2 dt psi I K (phi/phi_j)/(d_p sqrt(rho_p)).
    """
    loosest = parameters.loosest_solid_fraction
    steady = max(parameters.critical_solid_fraction - parameters.dilation_slope * number, loosest)
    dilatancy = parameters.dilatancy_coefficient * (increment.solid_fraction - steady)
    rate_per_root = number / (parameters.grain_diameter * math.sqrt(parameters.grain_density))
    b = 2.0 * increment.dt * dilatancy * rate_per_root * parameters.bulk_modulus * (1.0 + increment.compression)
    c = parameters.bulk_modulus * increment.compression
    root = math.sqrt(b * b + 4.0 * c)
    # Of the two forms of the root, the one that subtracts nothing.
    y = 0.5 * (b + root) if b > 0.0 else 2.0 * c / (root - b)
    friction = friction_of_inertial_number(
        number, parameters.static_friction, parameters.dynamic_friction, parameters.inertial_number_constant
    )
    strength = max(0.0, friction + dilatancy) * y * y
    shear_stress = increment.trial_shear_stress - increment.stiffness * rate_per_root * y
    return Flow(number, y * y, strength, shear_stress - strength)


flow_of_step = consistent_flow_of(flow_at, TOLERANCE)


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of longitudinal waves in flow, of an open point at the density of contact; (1) stiffens with p."""
    bulk_modulus = parameters.bulk_modulus + max(0.0, pressure(stress))
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    contact_density = max(density, parameters.grain_density * state.jamming_solid_fraction)
    return flowing_wave_speed(bulk_modulus, modulus, stress_ratio(stress), 0.0, contact_density)


def stored_energy(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Exact along isotropic paths; with dilatancy, and in the deviator, to the first order in the strain of volume."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    isotropic_part = energy_of_linear_compression(pressure(stress), density, parameters.bulk_modulus)
    return isotropic_part + energy_of_shear(stress, density, modulus)


def inconsistency(parameters: Parameters) -> str:
    """Friction may not fall with the shear rate, and flow may not be densest at its loosest."""
    return not_smaller(parameters, "dynamic_friction", "static_friction") or not_larger(
        parameters, "loosest_solid_fraction", "critical_solid_fraction"
    )


def density_of_slow_flow(mean_pressure: float, parameters: Parameters) -> float:
    """Bulk density [kg/m3] at rest, packed like slow flow."""
    return parameters.grain_density * parameters.critical_solid_fraction


DEM_SHEAR = Parameters(
    static_friction=0.492,
    dynamic_friction=0.706,
    inertial_number_constant=own_inertial_number_constant(0.3),
    critical_solid_fraction=0.5434,
    dilation_slope=2.0 * 0.115,
    loosest_solid_fraction=0.4,
    dilatancy_coefficient=4.09,
    bulk_modulus=1e6,
    poisson_ratio=0.2,
    grain_density=2450.0,
    grain_diameter=0.015,
)

LAW = Law(
    name="mu_i_phi_i",
    summary="mu(I), phi(I) rheology with elasticity and dilatancy delayed by shear",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    inconsistency=inconsistency,
    parameter_sets={
        "dem_shear": ParameterSet(
            DEM_SHEAR,
            "plane shear of discrete elements, friction 0.7 with rolling resistance, 12 to 18 mm: mu from 0.492 to "
            "0.706 with I_0 = 0.3 held, phi = 0.5434 - 0.115 I, in the engineering rate and over the wall's pressure; "
            "a from Pailha & Pouliquen (2009); K is a choice",
            density_of_slow_flow,
        ),
        "paper": ParameterSet(
            DEM_SHEAR._replace(
                static_friction=1.20 / math.sqrt(3.0),
                dynamic_friction=2.16 / math.sqrt(3.0),
                inertial_number_constant=0.279,
                bulk_modulus=392e3,
                grain_diameter=0.005,
            ),
            "friction and stiffness of `mu_i_lc`, Table 1 of its source; phi(I) and a as in dem_shear",
            density_of_slow_flow,
        ),
    },
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
