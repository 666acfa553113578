"""Weakly compressible Newtonian fluid, for verification: Couette, Poiseuille and dam-break flow have known answers.

    p = K (rho/rho_0 - 1),  s = 2 eta D_d;  stress-free where rho <= rho_0

In simple shear v_x = k y the shear stress is eta k, the usual definition of viscosity.

rho_0 follows for each point from its initial pressure and density, so that the initial state is in equilibrium. A fluid
that is to carry suction, as between moving walls, starts under a pressure that keeps it above rho_0.

Step limit. `sound_speed` covers waves alone. An explicit step is also bound by `viscosity`, to 3/16 rho h^2/eta on
cells of h where waves are slow; runs keep to it.

Source: Batchelor (1967), An Introduction to Fluid Dynamics, section 3.3, without volume viscosity; p is linear in rho.
Conventions: tensors tension-positive, p compression-positive.
Valid for speeds well below sqrt(K/rho_0): the density changes by (v/c)^2. A fluid does not rest before it is level.
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
    hookimpl,
    isotropic,
    pressure,
)


class Parameters(NamedTuple):
    """Material constants."""

    viscosity: Annotated[float, Parameter("Pa.s", "dynamic viscosity eta", "[0, inf)")]
    bulk_modulus: Annotated[float, Parameter("Pa", "bulk modulus K at rho_0", "(0, inf)")]


class State(NamedTuple):
    """What a point remembers."""

    reference_density: Annotated[
        float, StateVariable("kg/m3", "density rho_0 at which the pressure vanishes", output=False)
    ]


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """The reference density at which the compression law returns the present pressure."""
    return State(density / (1.0 + max(0.0, pressure(stress)) / parameters.bulk_modulus))


def update(
    stress: SymmetricTensor,
    strain_rate: SymmetricTensor,
    density: float,
    state: State,
    parameters: Parameters,
    dt: float,
) -> tuple[SymmetricTensor, State]:
    """The stress follows from density and strain rate alone."""
    compression = density / state.reference_density - 1.0
    if compression <= 0.0:
        return isotropic(0.0), state
    viscous = 2.0 * parameters.viscosity * deviator(strain_rate)
    return assembled_stress(parameters.bulk_modulus * compression, viscous), state


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of compression waves, dp/drho = K/rho_0."""
    return math.sqrt(parameters.bulk_modulus / state.reference_density)


def viscosity(
    stress: SymmetricTensor, strain_rate: SymmetricTensor, density: float, state: State, parameters: Parameters
) -> float:
    """Against a plane wave of compression, 4/3 eta."""
    return 4.0 / 3.0 * parameters.viscosity


def stored_energy(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Of the compression; the viscous stress stores nothing."""
    return energy_of_linear_compression(pressure(stress), density, parameters.bulk_modulus)


LAW = Law(
    name="newtonian",
    summary="weakly compressible Newtonian fluid, for verification",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    viscosity=viscosity,
    holds_in_single=True,
    parameter_sets={
        "glycerol": ParameterSet(
            Parameters(viscosity=1.41, bulk_modulus=1e5),
            "viscosity and density of glycerol at 20 degrees Celsius; K lowered from 4.4 GPa, so that sound is slow",
            lambda pressure, parameters: 1261.0 * (1.0 + pressure / parameters.bulk_modulus),
        )
    },
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
