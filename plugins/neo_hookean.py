"""Compressible Neo-Hookean elasticity, for verification at large strain.

    W = G/2 (tr b - 3) - G ln J + Lambda/2 (ln J)^2,   b = F F^T,   J = det F = rho_0/rho
    sigma = G/J (b - 1) + Lambda ln J / J 1,   Lambda = K - 2/3 G,   G = 3 (1 - 2 nu) / (2 (1 + nu)) K

The left Cauchy-Green tensor b needs no storage of its own: b = 1 + (J sigma - Lambda ln J)/G. What the caller has
rotated is therefore b itself; a step stretches it, b <- V b V with V = exp(D dt) to second order.

Source: Ogden (1984), Non-linear Elastic Deformations, with the volumetric term (ln J)^2 that the manufactured solutions
of Wallstedt & Guilkey (2008) and Kamojjala et al. (2015) use.
Conventions: stress and strain rate tension-positive.
Valid for J > 0 and steps of a few per cent of strain.
"""

import math
from typing import Annotated, Any, NamedTuple

from grainlaw.materials import (
    Law,
    Parameter,
    ParameterSet,
    StateVariable,
    SymmetricTensor,
    congruent,
    determinant,
    deviator,
    half_norm,
    hookimpl,
    isotropic,
    pointwise,
    pressure,
    shear_modulus,
    trace,
)

# ln J at the start is looked for in longer and longer steps from 0, then by halving down to round-off.
FIRST_LOG_VOLUME, LARGEST_LOG_VOLUME = 1e-6, 5.0
GROWTH = 1.5
HALVINGS = 60


class Parameters(NamedTuple):
    """Material constants."""

    bulk_modulus: Annotated[float, Parameter("Pa", "bulk modulus K at small strain", "(0, inf)")]
    poisson_ratio: Annotated[float, Parameter("1", "Poisson's ratio nu at small strain", "(-1, 0.5)")]


class State(NamedTuple):
    """What a point remembers besides its stress."""

    reference_density: Annotated[float, StateVariable("kg/m3", "density rho_0 without strain", output=False)]
    volume_ratio: Annotated[float, StateVariable("1", "J = rho_0/rho", output=False)]


@pointwise
def left_cauchy_green(stress: SymmetricTensor, volume_ratio: float, parameters: Parameters) -> SymmetricTensor:
    """The tensor b that belongs to a stress."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    volumetric = (parameters.bulk_modulus - 2.0 / 3.0 * modulus) * math.log(volume_ratio)
    return isotropic(1.0 - volumetric / modulus) + volume_ratio / modulus * stress


@pointwise
def excess_of_volume(log_volume: float, stress: SymmetricTensor, parameters: Parameters) -> float:
    """The difference det b - J^2 at a stress."""
    volume_ratio = math.exp(log_volume)
    return determinant(left_cauchy_green(stress, volume_ratio, parameters)) - volume_ratio * volume_ratio


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """The volume ratio next to 1 at which det b = J^2; NaN where none is, as above K/100 at nu = -0.97."""
    sign = -1.0 if excess_of_volume(0.0, stress, parameters) < 0.0 else 1.0
    near, far = 0.0, sign * FIRST_LOG_VOLUME
    while sign * excess_of_volume(far, stress, parameters) > 0.0:
        near, far = far, GROWTH * far
        if abs(far) > LARGEST_LOG_VOLUME:
            return State(math.nan, math.nan)
    for _ in range(HALVINGS):
        middle = 0.5 * (near + far)
        if sign * excess_of_volume(middle, stress, parameters) > 0.0:
            near = middle
        else:
            far = middle
    volume_ratio = math.exp(0.5 * (near + far))
    return State(density * volume_ratio, volume_ratio)


def update(
    stress: SymmetricTensor,
    strain_rate: SymmetricTensor,
    density: float,
    state: State,
    parameters: Parameters,
    dt: float,
) -> tuple[SymmetricTensor, State]:
    """Stretch b over one step and take the stress from it."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    strain = dt * strain_rate
    one = isotropic(1.0)
    stretch = one + strain + 0.5 * congruent(strain, one)
    b = congruent(stretch, left_cauchy_green(stress, state.volume_ratio, parameters))
    volume_ratio = state.reference_density / density
    volumetric = (parameters.bulk_modulus - 2.0 / 3.0 * modulus) * math.log(volume_ratio)
    new = (modulus * b + isotropic(volumetric - modulus)) / volume_ratio
    return new, State(state.reference_density, volume_ratio)


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of longitudinal waves along the largest stretch: rho J c^2 = G (b_max + 1) + Lambda (1 - ln J).

    b_max follows from a bound of the largest principal stress, -p + 2 tau/sqrt(3), which is exact in uniaxial tension.
    """
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    lame = parameters.bulk_modulus - 2.0 / 3.0 * modulus
    log_volume = math.log(state.volume_ratio)
    largest = 2.0 / math.sqrt(3.0) * half_norm(deviator(stress)) - pressure(stress)
    stiffness = state.volume_ratio * largest + 2.0 * modulus + lame * (1.0 - 2.0 * log_volume)
    return math.sqrt(max(stiffness, modulus) / (density * state.volume_ratio))


def stored_energy(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """W/rho_0, exact."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    lame = parameters.bulk_modulus - 2.0 / 3.0 * modulus
    log_volume = math.log(state.volume_ratio)
    stretch = trace(left_cauchy_green(stress, state.volume_ratio, parameters)) - 3.0
    energy = 0.5 * modulus * (stretch - 2.0 * log_volume) + 0.5 * lame * log_volume * log_volume
    return energy / state.reference_density


LAW = Law(
    name="neo_hookean",
    summary="compressible Neo-Hookean elasticity at large strain, for verification",
    carries_tension=True,
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    parameter_sets={
        "vortex": ParameterSet(
            Parameters(bulk_modulus=1e6 / (3.0 * (1.0 - 2.0 * 0.3)), poisson_ratio=0.3),
            source="generalised vortex (Kamojjala et al. 2015; de Vaucorbeil et al. 2020): E = 1 MPa, nu = 0.3, "
            "rho = 1000 kg/m3",
            density=lambda pressure, parameters: 1000.0,
            # a solid is sheared by 0.4, not by the 40 of grains that flow
            element_settings={"constant-pressure-shear": {"slow_inertial_number": 1e-5, "fast_inertial_number": 1e-3}},
        )
    },
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
