"""Linear elasticity in rate form, for verification.

    p_dot = K d(eps_v)/dt,   s_dot = 2 G D_d,   G = 3 (1 - 2 nu) / (2 (1 + nu)) K

Source: Hooke's law of isotropic bodies, Landau & Lifshitz (1970), Theory of Elasticity, section 4, as a rate.
Conventions: stress and strain rate tension-positive, pressure and volumetric strain compression-positive.
Valid for small elastic strains; the caller's objective rate carries large rotations.
"""

from typing import Annotated, Any, NamedTuple

from grainlaw.materials import (
    Law,
    Parameter,
    ParameterSet,
    SymmetricTensor,
    deviator,
    energy_of_logarithmic_compression,
    energy_of_shear,
    hookimpl,
    isotropic,
    longitudinal_wave_speed,
    pressure,
    shear_modulus,
    trace,
)


class Parameters(NamedTuple):
    """Material constants."""

    bulk_modulus: Annotated[float, Parameter("Pa", "bulk modulus K", "(0, inf)")]
    poisson_ratio: Annotated[float, Parameter("1", "Poisson's ratio nu", "(-1, 0.5)")]


class State(NamedTuple):
    """The stress is all the memory there is."""


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """No state variables."""
    return State()


def update(
    stress: SymmetricTensor,
    strain_rate: SymmetricTensor,
    density: float,
    state: State,
    parameters: Parameters,
    dt: float,
) -> tuple[SymmetricTensor, State]:
    """Hooke's law over one step."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    volumetric = isotropic(parameters.bulk_modulus * dt * trace(strain_rate))
    return stress + (volumetric + 2.0 * modulus * dt * deviator(strain_rate)), state


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of longitudinal waves."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    return longitudinal_wave_speed(parameters.bulk_modulus, modulus, density)


def stored_energy(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Exact along isotropic paths; the deviator's part to the first order in the strain of volume."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    isotropic_part = energy_of_logarithmic_compression(pressure(stress), density, parameters.bulk_modulus)
    return isotropic_part + energy_of_shear(stress, density, modulus)


LAW = Law(
    name="linear_elastic",
    summary="linear elasticity in rate form, for verification",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    carries_tension=True,
    parameter_sets={
        "soft_solid": ParameterSet(
            Parameters(bulk_modulus=1000.0 / (3.0 * (1.0 - 2.0 * 0.3)), poisson_ratio=0.3),
            source="two elastic discs of Sulsky et al. (1994): E = 1000 Pa, nu = 0.3, rho = 1000 kg/m3",
            density=lambda pressure, parameters: 1000.0,
        )
    },
    holds_in_single=True,
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
