"""mu(I), state: one law of grains that stand, fail and flow; strength and dilatancy follow packing, pressure and rate.

    p       = E z^2,   z = 1 - phi_j/phi, stress-free where phi <= phi_j                       (1)
    mu(I)   = mu_0 + (mu_d - mu_0) / (I_0/I + 1),   phi_s(I) = max(phi_0 - chi I, phi_min)     (2)
    psi     = a (phi_j - phi_s(I) (1 + b z))                                                   (3)
    d(ln phi_j) = -2 psi gamma_dot^p dt + k <phi_l - phi_j> sqrt(p/rho_p)/d_p dt + b <dz>_m    (4)
    phi_l   = (phi_s(I) + (phi_n - phi_0) <1 - tau/(mu p)>) (1 + b z)                          (5)
    s_dot   = 2 G (D_d - D^p) + s (ln sqrt(G rho))_dot,   G = 2 r E z,   D^p = gamma_dot^p s/tau  (6)
    tau    <= S p,   S = max(mu(I) + (1 - N) psi, (1 + z) psi, 0)                              (7)
    I       = gamma_dot^p d_p / sqrt(p/rho_p)                                                  (8)

<x> = max(x, 0), and r = G/K from Poisson's ratio. phi_j is the packing at which contact is lost, z the elastic strain
of volume. The bulk modulus of (1), K = 2 E z (1 - z), grows with the root of pressure.

Packing. psi is the dilatancy, per engineering strain (twice gamma_dot): what is denser than the critical state at the
present pressure and rate loosens, what is looser compacts, until it flows steadily with tau = mu(I) p and phi_j =
phi_s(I) (1 + b z). Of psi, the strength shows the share 1 - N. First compression compacts by b dz, at z = z_m, which
follows the plastic volume, dz_m = d(ln phi_j)/b, never below z. What is looser than phi_l carries no lasting stress:
it settles, to phi_n at rest; in steady flow phi_l is the critical state.

Energy. Per volume p z/(3 (1 - z)) + tau^2/(2 G) is held. Because of the last term of (6) it is a function of the state:
elastic cycles through any pressures return what they took. Shear dissipates 2 (S p - psi (p + p z/(3 (1 - z))))
gamma_dot^p >= 0, by the second term of (7); settling and compaction dissipate too.

A step. I is the unknown, found in a bracket (`plugins/mu_i/state_step.py`, `consistent_flow.py`). Looser than phi_min,
compaction can take the pressure faster than any I uses up the shear: then the grains part, p = 0, phi_j = phi. Open
points neither flow nor dilate, and close where they opened. A root that is not found makes the stress NaN.

Contains: at a = 0 the friction mu(I) at constant phi_j; at chi = 0 and slow shear a law without rate, whose critical
states are tau = mu_0 p on the line phi = phi_0 (1 + b z)/(1 - z).

Source: state parameter after Been & Jefferies (1985), Geotechnique 35, and NorSand, Jefferies (1993), Geotechnique 43;
dilatancy in flow after Roux & Radjai (1998) and Pailha & Pouliquen (2009), J. Fluid Mech. 633; phi(I) as in Forterre &
Pouliquen (2008). Their combination, (4) to (7) and the integration are this project's.
Conventions: tensors tension-positive, p compression-positive; tau = sqrt(1/2 s:s), gamma_dot = sqrt(1/2 D_d:D_d), so
I_0 and 1/chi belong to half of the engineering rate.
Valid from rest to dense flow, I below 0.5, p far below E; no fabric, collisions, breakage, nor length.
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
    energy_of_shear,
    flowing_wave_speed,
    half_norm,
    hookimpl,
    isotropic,
    longitudinal_wave_speed,
    not_larger,
    not_smaller,
    pointwise,
    pressure,
    shear_modulus,
    stress_ratio,
    trace,
)
from grainlaw.materials.elementary import exponential
from grainlaw.plugins.mu_i.state_step import Increment, flow_of_step, unused_friction

# Solid fraction phi_j of the set `paper_dense`.
DENSE = 0.61


class Parameters(NamedTuple):
    """Material constants."""

    static_friction: Annotated[float, Parameter("1", "friction coefficient mu_0 of slow flow", "[0, inf)")]
    dynamic_friction: Annotated[float, Parameter("1", "friction coefficient mu_d of fast flow", "[0, inf)")]
    inertial_number_constant: Annotated[
        float, Parameter("1", "I_0, where mu is halfway from mu_0 to mu_d; for the rate sqrt(1/2 D_d:D_d)", "(0, inf)")
    ]
    critical_solid_fraction: Annotated[
        float, Parameter("1", "solid fraction phi_0 of slow flow, without its elastic part", "(0, 1)")
    ]
    dilation_slope: Annotated[
        float, Parameter("1", "chi, loss of solid fraction per I; for the rate sqrt(1/2 D_d:D_d)", "[0, inf)")
    ]
    loosest_solid_fraction: Annotated[float, Parameter("1", "smallest solid fraction phi_min of flow", "(0, 1)")]
    resting_solid_fraction: Annotated[
        float, Parameter("1", "phi_n, loosest solid fraction that carries a pressure at rest", "(0, 1)")
    ]
    settling_rate: Annotated[
        float, Parameter("1", "k, of what is too loose, in units of sqrt(p/rho_p)/d_p", "[0, inf)")
    ]
    dilatancy_coefficient: Annotated[
        float, Parameter("1", "a, dilatancy psi per excess of solid fraction over the critical state", "[0, inf)")
    ]
    hidden_dilatancy: Annotated[float, Parameter("1", "N, share of psi that does not add to the friction", "[0, 1]")]
    stiffness: Annotated[float, Parameter("Pa", "E, pressure over the squared elastic strain of volume", "(0, inf)")]
    compaction: Annotated[
        float, Parameter("1", "b, plastic over elastic strain of volume in first compression", "(0, inf)")
    ]
    poisson_ratio: Annotated[float, Parameter("1", "Poisson's ratio nu", "(-1, 0.5)")]
    grain_density: Annotated[float, Parameter("kg/m3", "density rho_p of the grains", "(0, inf)")]
    grain_diameter: Annotated[float, Parameter("m", "diameter d_p of the grains", "(0, inf)")]


class State(NamedTuple):
    """What a point remembers."""

    jamming_solid_fraction: Annotated[
        float, StateVariable("1", "solid fraction phi_j at which the grains lose contact", output=False)
    ]
    consolidation_strain: Annotated[
        float, StateVariable("1", "elastic strain z_m beyond which compression compacts", output=False)
    ]
    inertial_number: Annotated[float, StateVariable("1", "plastic inertial number I of the last step")]


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """At rest, with the packing at which (1) returns the present pressure, which is the largest that it has borne.

    NaN for a pressure of E and more, which no packing has.
    """
    z = elastic_strain_of(pressure(stress), parameters)
    return State(density / parameters.grain_density * (1.0 - z) if z < 1.0 else math.nan, z, 0.0)


@pointwise
def elastic_strain_of(mean_pressure: float, parameters: Parameters) -> float:
    """Z of (1), zero without pressure."""
    return math.sqrt(max(0.0, mean_pressure) / parameters.stiffness)


@pointwise
def shear_modulus_at(elastic_strain: float, parameters: Parameters) -> float:
    """G of (6) [Pa]."""
    return shear_modulus(2.0 * parameters.stiffness * elastic_strain, parameters.poisson_ratio)


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
        return isotropic(0.0), State(state.jamming_solid_fraction, state.consolidation_strain, 0.0)

    last_pressure, last = max(0.0, pressure(stress)), deviator(stress)
    last_strain = elastic_strain_of(last_pressure, parameters)
    modulus = shear_modulus_at(last_strain, parameters)
    trial = last + 2.0 * modulus * dt * deviator(strain_rate)
    reference_strain = last_strain * exponential(trace(strain_rate) * dt)
    shear_per_number = dt / parameters.grain_diameter * math.sqrt(parameters.stiffness / parameters.grain_density)
    excess_at_rest = parameters.resting_solid_fraction - parameters.critical_solid_fraction
    unused = unused_friction(half_norm(last), last_pressure, state.inertial_number, parameters)
    increment = Increment(
        solid_fraction,
        compression,
        reference_strain,
        state.consolidation_strain,
        excess_at_rest * unused,
        shear_per_number,
        half_norm(trial),
        2.0 * modulus * shear_per_number,
    )
    flow = flow_of_step(increment, state.inertial_number, parameters)
    z = flow.contact
    jamming = solid_fraction * (1.0 - z)
    compaction = jamming / state.jamming_solid_fraction - 1.0
    consolidation = max(z, state.consolidation_strain + compaction / parameters.compaction)
    if z == 0.0:
        return isotropic(0.0), State(jamming, consolidation, 0.0)
    elastic, yielding = 2.0 * z / (z + reference_strain), flow.strength / max(increment.trial_shear_stress, 1e-300)
    factor = elastic if flow.number == 0.0 else yielding
    return assembled_stress(parameters.stiffness * z * z, factor * trial), State(jamming, consolidation, flow.number)


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of the fastest wave, in flow or along the axis in which (6) stiffens most; zero where the point is open."""
    z = elastic_strain_of(pressure(stress), parameters)
    if z == 0.0:
        return 0.0
    bulk_modulus, modulus = 2.0 * parameters.stiffness * z, shear_modulus_at(z, parameters)
    ratio = stress_ratio(stress)
    flowing = flowing_wave_speed(bulk_modulus, modulus, ratio, 0.0, density)
    # Pressure carries s along, by s/(4 p), at most 2/sqrt(3) tau/(4 p) along an axis.
    stiffened = bulk_modulus * (1.0 + ratio / (2.0 * math.sqrt(3.0)))
    return max(flowing, longitudinal_wave_speed(stiffened, modulus, density))


def stored_energy(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """The integral of p/rho^2 d(rho) at constant phi_j, p z/(3 rho (1 - z)), and that of shear."""
    p = max(0.0, pressure(stress))
    z = elastic_strain_of(p, parameters)
    if z == 0.0:
        return 0.0
    return p * z / (3.0 * density * (1.0 - z)) + energy_of_shear(stress, density, shear_modulus_at(z, parameters))


def inconsistency(parameters: Parameters) -> str:
    """Friction may not fall with the shear rate; flow may not be densest at its loosest, nor denser than rest."""
    return (
        not_smaller(parameters, "dynamic_friction", "static_friction")
        or not_larger(parameters, "loosest_solid_fraction", "critical_solid_fraction")
        or not_smaller(parameters, "resting_solid_fraction", "critical_solid_fraction")
    )


def density_at_rest(mean_pressure: float, parameters: Parameters) -> float:
    """Bulk density [kg/m3] of the loosest packing that rests under a pressure."""
    z = elastic_strain_of(mean_pressure, parameters)
    return parameters.grain_density * parameters.resting_solid_fraction * (1.0 + parameters.compaction * z) / (1.0 - z)


def density_of_dense_packing(mean_pressure: float, parameters: Parameters) -> float:
    """Bulk density [kg/m3] of a packing whose phi_j is 0.61, or of the loosest at rest where that is denser."""
    pressed = parameters.grain_density * DENSE / (1.0 - elastic_strain_of(mean_pressure, parameters))
    return max(pressed, density_at_rest(mean_pressure, parameters))


DEM = Parameters(
    static_friction=0.515,
    dynamic_friction=0.900,
    inertial_number_constant=0.252,
    critical_solid_fraction=0.5382,
    dilation_slope=0.249,
    loosest_solid_fraction=0.4,
    resting_solid_fraction=0.548,
    settling_rate=1.0,
    dilatancy_coefficient=6.95,
    hidden_dilatancy=0.481,
    stiffness=16.5e6,
    compaction=0.0170,
    poisson_ratio=0.2,
    grain_density=2450.0,
    grain_diameter=0.015,
)

PAPER = DEM._replace(
    static_friction=1.20 / math.sqrt(3.0),
    dynamic_friction=2.16 / math.sqrt(3.0),
    inertial_number_constant=0.279,
    stiffness=392e3**2 / 4000.0,
    grain_diameter=0.005,
)
SOURCE = "friction of `mu_i_lc`, Table 1 of its source, and its stiffness at 1000 Pa; the rest as in dem"

LAW = Law(
    name="mu_i_state",
    summary="state-parameter mu(I): one law for standing, failing and flowing grains",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    inconsistency=inconsistency,
    parameter_sets={
        "dem": ParameterSet(
            DEM,
            "fitted to steady shear, start of shear and compression of discrete elements, friction 0.7 with rolling "
            "resistance, 12 to 18 mm; phi_n the looser of two compressed packings; phi_min, k and nu are choices",
            density_at_rest,
        ),
        "paper": ParameterSet(PAPER, f"{SOURCE}; as loose as can rest", density_at_rest),
        "paper_dense": ParameterSet(
            PAPER,
            f"{SOURCE}; dense, phi_j = 0.61",
            density_of_dense_packing,
            {"constant-pressure-shear": {"density": 1500.0}},
        ),
    },
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
