"""mu(I)-LC rheology as published: a regularised viscosity without elasticity in shear.

    p   = K_LC (phi/phi_ref - 1), stress-free where phi <= phi_ref                           (paper Eq. 6)
    s   = eta D_d                                                                            (paper Eq. 3)
    eta = mu_0 p / sqrt(gamma_dot^2 + alpha^2) + (mu_d - mu_0) p d_p / (I_0 sqrt(p/rho_p) + d_p gamma_dot)    (Eq. 5)

The printed Eq. 5 lacks d_p in the numerator and has d_p gamma_dot under the root; this form has the dimension of a
viscosity and returns Eqs. 2 and 4 at alpha = 0.

Step limit. `sound_speed` covers waves alone. `viscosity` bounds an explicit step too, to about 3/4 rho h^2/eta on cells
of h, and near rest eta ~ mu_0 p/alpha: far below any step that a run can afford, so that runs do not keep to it. The
stress of slow points then chatters between the signs of the yield stress and a pile creeps for ever: this law is here
to be compared with, `mu_i_lc` is the one to use.

Source: paper = "A comparative study of granular solid-like and fluid-like constitutive laws", EPJ
Web of Conferences 340, 02014 (2025), doi 10.1051/epjconf/202534002014, Eqs. 1-6, Table 1;
regularisation after Franci & Cremonesi (2019).
Conventions and range of validity: as `mu_i_lc`.
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
    half_norm,
    hookimpl,
    not_smaller,
    pointwise,
    pressure,
    stress_ratio,
)


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
    regularisation_rate: Annotated[
        float, Parameter("1/s", "rate alpha below which the viscosity saturates", "[0, inf)")
    ]
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
    """Linear compression and s = eta D_d."""
    solid_fraction = density / parameters.grain_density
    p = max(0.0, parameters.bulk_modulus * (solid_fraction / state.reference_solid_fraction - 1.0))
    rate_tensor = deviator(strain_rate)
    rate = half_norm(rate_tensor)

    return assembled_stress(p, apparent_viscosity(p, rate, parameters) * rate_tensor), state


@pointwise
def apparent_viscosity(pressure: float, rate: float, parameters: Parameters) -> float:
    """The viscosity eta [Pa s] of Eq. 5, zero without pressure."""
    friction_rate = math.sqrt(rate * rate + parameters.regularisation_rate * parameters.regularisation_rate)
    inertial_rate = parameters.inertial_number_constant * math.sqrt(pressure / parameters.grain_density)
    inertial_rate += parameters.grain_diameter * rate
    if not (friction_rate > 0.0 and inertial_rate > 0.0):
        return 0.0
    extra_friction = parameters.dynamic_friction - parameters.static_friction
    return pressure * (
        parameters.static_friction / friction_rate + extra_friction * parameters.grain_diameter / inertial_rate
    )


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of compression waves at a constant rate of strain, in which s = eta D_d grows with p (see the header).

    dp/d(ln rho) = K_LC phi/phi_ref = K_LC + p, of which s along the wave adds the share 2/sqrt(3) tau/p at most. An
    open point counts at the density of contact.
    """
    bulk_modulus = parameters.bulk_modulus + max(0.0, pressure(stress))
    contact_density = max(density, parameters.grain_density * state.reference_solid_fraction)
    return math.sqrt(bulk_modulus * (1.0 + 2.0 / math.sqrt(3.0) * stress_ratio(stress)) / contact_density)


def stored_energy(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Of the compression; the viscous stress stores nothing."""
    return energy_of_linear_compression(pressure(stress), density, parameters.bulk_modulus)


def viscosity(
    stress: SymmetricTensor, strain_rate: SymmetricTensor, density: float, state: State, parameters: Parameters
) -> float:
    """Against a plane wave of compression, 2/3 eta."""
    rate = half_norm(deviator(strain_rate))
    return 2.0 / 3.0 * apparent_viscosity(max(0.0, pressure(stress)), rate, parameters)


def inconsistency(parameters: Parameters) -> str:
    """Friction may not fall with the shear rate: slow and fast flow would then be possible at one stress."""
    return not_smaller(parameters, "dynamic_friction", "static_friction")


def density_of_table_1(mean_pressure: float, parameters: Parameters) -> float:
    """Bulk density [kg/m3] with Table 1's phi_ref = 1.317 (see `mu_i_lc`)."""
    return 1.317 * parameters.grain_density * (1.0 + mean_pressure / parameters.bulk_modulus)


LAW = Law(
    name="mu_i_lc_viscous",
    summary="mu(I) rheology with linear compression and regularised viscosity, explicit as published; creeps at rest",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    viscosity=viscosity,
    viscosity_bounds_step=False,
    holds_in_single=True,
    inconsistency=inconsistency,
    parameter_sets={
        "paper": ParameterSet(
            Parameters(
                static_friction=1.20 / math.sqrt(3.0),
                dynamic_friction=2.16 / math.sqrt(3.0),
                inertial_number_constant=0.279,
                bulk_modulus=392e3,
                regularisation_rate=1e-4,
                grain_density=2450.0,
                grain_diameter=0.005,
            ),
            "Table 1; alpha from the text",
            density_of_table_1,
        )
    },
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
