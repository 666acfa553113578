"""Cohesionless elastic, perfectly plastic Drucker-Prager law with linear compression: a law to complete.

    p      = K (phi/phi_ref - 1), stress-free where phi <= phi_ref                           (1)
    s_dot  = 2 G D_d,   G = 3 (1 - 2 nu) / (2 (1 + nu)) K                                    (2)
    F      = q - M p <= 0, with radial return of s to F = 0                                  (3)

Source: Drucker & Prager (1952), Q. Appl. Math. 10, without cohesion; plastic flow at constant volume.
Conventions: tensors tension-positive; p, phi compression-positive; q = sqrt(3/2 s:s).
phi_ref follows for each point from its initial pressure and density, so that the initial state is in equilibrium.
Valid for slow flow at critical state: the law knows neither rate nor dilatancy.
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
    flowing_wave_speed,
    hookimpl,
    pressure,
    shear_modulus,
)


class Parameters(NamedTuple):
    """Material constants."""

    critical_state_ratio: Annotated[float, Parameter("1", "slope M = q/p of the yield surface", "[0, inf)")]
    bulk_modulus: Annotated[float, Parameter("Pa", "bulk modulus K of the linear compression law", "(0, inf)")]
    poisson_ratio: Annotated[float, Parameter("1", "Poisson's ratio nu", "(-1, 0.5)")]
    grain_density: Annotated[float, Parameter("kg/m3", "density rho_p of the grains", "(0, inf)")]


class State(NamedTuple):
    """What a point remembers."""

    reference_solid_fraction: Annotated[
        float, StateVariable("1", "solid fraction phi_ref at which the grains lose contact", output=False)
    ]


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """The reference solid fraction at which Eq. 1 returns the present pressure."""
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
    """Linear compression (1) and elastic shear (2); the return to the yield surface (3) is still to be written."""
    solid_fraction = density / parameters.grain_density
    p = max(0.0, parameters.bulk_modulus * (solid_fraction / state.reference_solid_fraction - 1.0))

    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    trial = deviator(stress) + 2.0 * modulus * dt * deviator(strain_rate)
    factor = 1.0 if p > 0.0 else 0.0
    return assembled_stress(p, factor * trial), state


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of longitudinal waves in flow, where tau/p is M/sqrt(3); by Eq. 1 dp/d(ln rho) is K + p."""
    bulk_modulus = parameters.bulk_modulus + max(0.0, pressure(stress))
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    return flowing_wave_speed(bulk_modulus, modulus, parameters.critical_state_ratio / math.sqrt(3.0), 0.0, density)


def density_at_rest(mean_pressure: float, parameters: Parameters) -> float:
    """Bulk density [kg/m3] of grains that touch at a solid fraction of 0.6."""
    return 0.6 * parameters.grain_density * (1.0 + mean_pressure / parameters.bulk_modulus)


LAW = Law(
    name="coulomb_example",
    summary="cohesionless elastic, perfectly plastic Drucker-Prager law, to be completed",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    parameter_sets={
        "sand": ParameterSet(
            Parameters(critical_state_ratio=1.2, bulk_modulus=392e3, poisson_ratio=0.2, grain_density=2450.0),
            "M, K and grain density as in Table 1 of the paper",
            density_at_rest,
        )
    },
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
