"""Drucker-Prager plasticity: friction, cohesion and dilatancy of their own, returned in closed form.

    F   = tau - A p - k <= 0                                                                 (1)
    D^p = gamma_dot^p [s/(2 tau) + B/3 1]                                                    (2)
    p_dot = K (d(eps_v)/dt + B gamma_dot^p),   s_dot = 2 G (D_d - D^p_d)                     (3)
    B   = sin(psi) / sqrt(1 + sin(psi)^2/3)                                                  (4)
    A   = sin(phi) / n,  k = c cos(phi) / n,  n = sqrt(1 - B^2/3) + B sin(phi)/3             (5)

Matching. A and k are those of plane strain: where the plastic rate along z vanishes, (2) fixes s_zz = -2 B tau/3, and
(5) is the Mohr-Coulomb strength with friction angle phi and cohesion c, (4) the dilatancy angle psi, both exact. For
psi = phi (5) is the usual A = 3 tan(phi)/sqrt(9 + 12 tan(phi)^2); for psi = 0 it is A = sin(phi). Bui et al. (2008)
take the former although their flow does not dilate: 0.332 in place of 0.339 for their angle of 19.8 degrees.

Return. Along (2) the trial state (p*, tau*) moves by K B gamma^p and -G gamma^p: with the plastic shear gamma^p of

    gamma^p = (tau* - A p* - k) / (G + A K B)                                                (6)

it is on the cone. If that leads below its apex the state is the apex, p = -k/A, s = 0; of the volume that is left, what
(2) does not account for is an opening. It is kept as `opening_strain`, which has to close before the pressure departs
from the apex. With A = 0 there is no apex if k > 0; with k = 0 besides, the cone is the axis p >= 0: a fluid that
cannot be pulled.

Source: Drucker & Prager (1952), Q. Appl. Math. 10; the bars: Bui, Fukagawa, Sako & Ohno (2008), Int. J. Numer. Anal.
Meth. Geomech. 32.
Conventions: tensors tension-positive, p compression-positive; tau = sqrt(1/2 s:s); gamma_dot^p is the engineering rate.
Valid for slow flow. With psi > 0 the material dilates for ever, since no density ends it; an opened cohesive point
keeps the tension of the apex, however far it opens.
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
    not_larger,
    pointwise,
    pressure,
    shear_modulus,
    strain_in_contact,
    volumetric_strain_rate,
)


class Parameters(NamedTuple):
    """Material constants."""

    friction_angle: Annotated[float, Parameter("rad", "Mohr-Coulomb friction angle phi in plane strain", "[0, 1.5]")]
    dilatancy_angle: Annotated[float, Parameter("rad", "dilatancy angle psi; at most the friction angle", "[0, 1.5]")]
    cohesion: Annotated[float, Parameter("Pa", "Mohr-Coulomb cohesion c", "[0, inf)")]
    bulk_modulus: Annotated[float, Parameter("Pa", "bulk modulus K", "(0, inf)")]
    poisson_ratio: Annotated[float, Parameter("1", "Poisson's ratio nu", "(-1, 0.5)")]


class State(NamedTuple):
    """What a point remembers."""

    opening_strain: Annotated[
        float, StateVariable("1", "volumetric strain of opening beyond the apex; 0 while in contact")
    ]


class Strength(NamedTuple):
    """The cone of (4) and (5): tau = friction p + cohesion, and the plastic dilation per plastic shear."""

    friction: float
    cohesion: float
    dilatancy: float


@pointwise
def strength_of(parameters: Parameters) -> Strength:
    """The cone that has the Mohr-Coulomb strength and dilatancy in plane strain."""
    sine = math.sin(parameters.friction_angle)
    sine_dilatancy = math.sin(parameters.dilatancy_angle)
    dilatancy = sine_dilatancy / math.sqrt(1.0 + sine_dilatancy * sine_dilatancy / 3.0)
    n = math.sqrt(1.0 - dilatancy * dilatancy / 3.0) + dilatancy * sine / 3.0
    return Strength(sine / n, parameters.cohesion * math.cos(parameters.friction_angle) / n, dilatancy)


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """In contact; the stress is the rest of the memory."""
    return State(0.0)


def update(
    stress: SymmetricTensor,
    strain_rate: SymmetricTensor,
    density: float,
    state: State,
    parameters: Parameters,
    dt: float,
) -> tuple[SymmetricTensor, State]:
    """Close an opened point, then the elastic trial step and the return to the cone or its apex."""
    strain = strain_in_contact(
        volumetric_strain_rate(strain_rate) * dt, dt * deviator(strain_rate), state.opening_strain
    )
    if strain.opening_strain > 0.0:
        return stress, State(strain.opening_strain)

    bulk_modulus = parameters.bulk_modulus
    modulus = shear_modulus(bulk_modulus, parameters.poisson_ratio)
    trial_pressure = pressure(stress) + bulk_modulus * strain.compression
    trial = deviator(stress) + 2.0 * modulus * strain.shear
    trial_tau = half_norm(trial)

    cone = strength_of(parameters)
    # Without friction: 0 without cohesion, else out of reach.
    apex = -cone.cohesion / max(cone.friction, 1e-300)
    overstress = trial_tau - cone.friction * trial_pressure - cone.cohesion
    if overstress <= 0.0 and trial_pressure >= apex:
        return assembled_stress(trial_pressure, trial), State(0.0)
    plastic_shear = max(0.0, overstress) / (modulus + cone.friction * bulk_modulus * cone.dilatancy)
    tau = trial_tau - modulus * plastic_shear
    new_pressure = trial_pressure + bulk_modulus * cone.dilatancy * plastic_shear
    # The pressure decides: on a narrow cone, the sign of tau is round-off.
    if tau > 0.0 and new_pressure >= apex:
        return assembled_stress(new_pressure, trial * (tau / trial_tau)), State(0.0)
    if new_pressure > apex:
        return isotropic(-new_pressure), State(0.0)

    dilation = cone.dilatancy * trial_tau / modulus
    return isotropic(-apex), State(max(0.0, (apex - trial_pressure) / bulk_modulus - dilation))


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of longitudinal waves in flow, faster than in rest; of an open point, at the density of contact."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    cone = strength_of(parameters)
    return flowing_wave_speed(
        parameters.bulk_modulus, modulus, cone.friction, cone.dilatancy, density * math.exp(state.opening_strain)
    )


def stored_energy(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Exact along isotropic paths; where plastic flow dilates, and in the deviator, to first order in strain."""
    modulus = shear_modulus(parameters.bulk_modulus, parameters.poisson_ratio)
    isotropic_part = energy_of_logarithmic_compression(pressure(stress), density, parameters.bulk_modulus)
    return isotropic_part + energy_of_shear(stress, density, modulus)


def inconsistency(parameters: Parameters) -> str:
    """Flow that dilates more than friction allows would give out energy."""
    return not_larger(parameters, "dilatancy_angle", "friction_angle")


ALUMINIUM_BARS = Parameters(
    friction_angle=math.radians(19.8), dilatancy_angle=0.0, cohesion=0.0, bulk_modulus=0.7e6, poisson_ratio=0.3
)

LAW = Law(
    name="drucker_prager",
    summary="Drucker-Prager plasticity with cohesion, dilatancy of its own and an exact tension apex",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    inconsistency=inconsistency,
    parameter_sets={
        "aluminium_bars": ParameterSet(
            ALUMINIUM_BARS,
            "two-dimensional stack of aluminium bars, Bui et al. (2008), friction angle 19.8 degrees",
            lambda pressure, parameters: 2650.0 * math.exp(pressure / parameters.bulk_modulus),
        ),
        "paper": ParameterSet(
            Parameters(
                friction_angle=math.asin(1.20 / math.sqrt(3.0)),
                dilatancy_angle=0.0,
                cohesion=0.0,
                bulk_modulus=392e3,
                poisson_ratio=0.2,
            ),
            "A = mu_0 = M/sqrt(3) and K_LC of Table 1 of the paper behind `mu_i_lc`; psi = 0",
            lambda pressure, parameters: 1500.0 * math.exp(pressure / parameters.bulk_modulus),
        ),
    },
    holds_in_single=True,
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
