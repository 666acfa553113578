"""mu(I)-MCC: Modified Cam Clay whose critical state depends on the inertial number; one law for solid and flow.

    (q/(M_csl p))^2 = (2 xi - 1) M_I^2,   xi = p_s/p,   p_s = p_c/2                          (1)
    M_I = 1 + (M_inf/M_csl - 1) I/(I_M + I)                                                  (2)
    v = v_csl(p_s) (p_s/p)^kappa exp(I/I_v),   v_csl = exp(Gamma) p_s^-lambda                (3)
    d(eps_v^p) = (lambda - kappa) d(ln p_s) - dI/I_v                                         (4)
    d(eps^p) = dLambda [3/M^2 s - (2p - p_c)/3 1],   M = M_csl M_I                           (5)
    I = gamma_dot^p d_p / sqrt(p/rho_p)                                                      (6)

Derivation. (1) is q^2 = M^2 p (p_c - p), the ellipse of Modified Cam Clay with the slope M(I) of (2). (3) puts the
steady state p = p_s at v_csl(p) exp(I/I_v), with swelling by kappa away from it; -d(ln v) less the elastic part
kappa d(ln p) is (4). (4) integrates, whatever the history of I, to

    p_c = p_c0 exp(I / (I_v (lambda - kappa))),   d(ln p_c0) = d(eps_v^p) / (lambda - kappa) (7)

where p_c0, the size of the surface at rest, hardens as in Cam Clay and is the state variable. Flow (5) is associated
with the surface at the present I: no volume change where 2p = p_c, which is where q/p = M(I) on (1). So steady shear is
at q/p = M(I) and v = v_csl(p) exp(I/I_v); and I_M, I_v -> infinity leave M = M_csl and p_c = p_c0: Cam Clay.
A change of the shear rate moves the surface at once, p_c0 only as volume changes: hence overshoot and dilation.
Dissipation is (p (2p - p_c) + 2 q^2/M^2) dLambda = p p_c dLambda >= 0.

A step. I is the plastic inertial number of the step, with p at its end. For an assumed I the step is one of Cam Clay
with M(I) and p_c(I) (`cam_clay_step`, exact and bracketed), and gives back a plastic shear, so an inertial number. A
larger assumed I makes a larger surface, so less plastic shear: what is found falls while what is assumed rises. The one
root is found by the secant method, begun at the I of the step before, with bisection wherever that leaves its bracket.
The return of Cam Clay leaves a trace of F, which a fast step would magnify in I; its end lies exactly on the surface of
a slightly different I, and that one counts as assumed. An elastic step gives the largest I at which there is flow.
A step of some per cent can soften so much that its return jumps over that root; it is then taken in equal parts.

Grains carry no tension: opened points keep a gap, as in `modified_cam_clay`.

Source: (1)-(4) as published with the HydraxMPM code, Lubbe et al. (2026), and the idea of mu(I)-MCC in Blatny et al.
(2024); flow rule, (7) and integration are this project's.
Conventions: tensors tension-positive; p, eps_v compression-positive; q = sqrt(3/2 s:s); gamma_dot = sqrt(1/2 D_d:D_d),
so I_M and I_v belong to half of the engineering rate (`own_inertial_number_constant` converts literature values).
Valid from rest to dense flow, I below 1; beyond, collisions carry stress that (3) does not know.
"""

import math
from typing import Annotated, Any, NamedTuple

from materials import (
    CamClay,
    CamClayStep,
    Law,
    Parameter,
    ParameterSet,
    StateVariable,
    SymmetricTensor,
    after_closing,
    assembled_stress,
    cam_clay_step,
    contraction,
    deviator,
    deviatoric_stress,
    energy_of_cam_clay,
    half_norm,
    hookimpl,
    inertial_number,
    isotropic,
    log_volume_of_figure_1,
    longitudinal_wave_speed,
    own_inertial_number_constant,
    pointwise,
    pressure,
    scaled,
    shear_modulus,
    volumetric_strain_rate,
)

# Of the yield surface by the inertial number found against the one assumed.
TOLERANCE = 1e-9
MAXIMUM_ITERATIONS = 60
ROUND_OFF = 1e-15
# The same; more means that the return jumps.
LARGEST_MISMATCH = 1e-6
# Strain below which a return does not jump.
SMALLEST_PART = 1e-4
# exp of this is beyond any pressure, and its square still a number.
LARGEST_EXPONENT = 300.0


class Parameters(NamedTuple):
    """Material constants."""

    critical_state_ratio: Annotated[float, Parameter("1", "slope M_csl = q/p of slow steady shear", "(0, inf)")]
    dynamic_state_ratio: Annotated[float, Parameter("1", "slope M_inf = q/p of fast steady shear", "(0, inf)")]
    friction_inertial_number: Annotated[
        float, Parameter("1", "I_M, where q/p is halfway from M_csl to M_inf; for sqrt(1/2 D_d:D_d)", "(0, inf)")
    ]
    dilation_inertial_number: Annotated[
        float,
        Parameter("1", "I_v, over which the steady specific volume grows by e; for sqrt(1/2 D_d:D_d)", "(0, inf)"),
    ]
    compression_index: Annotated[
        float, Parameter("1", "slope lambda of isotropic compression in ln v - ln p; larger than kappa", "(0, inf)")
    ]
    swelling_index: Annotated[float, Parameter("1", "slope kappa of swelling in ln v - ln p", "(0, inf)")]
    poisson_ratio: Annotated[float, Parameter("1", "Poisson's ratio nu", "(-1, 0.5)")]
    overconsolidation_ratio: Annotated[
        float,
        Parameter("1", "OCR: size of the initial yield surface over the one through the initial stress", "[1, inf)"),
    ]
    grain_density: Annotated[float, Parameter("kg/m3", "density rho_p of the grains", "(0, inf)")]
    grain_diameter: Annotated[float, Parameter("m", "diameter d_p of the grains", "(0, inf)")]
    stress_free_pressure: Annotated[
        float, Parameter("Pa", "pressure below which grains are taken to lose contact", "(0, inf)")
    ] = 1.0


class State(NamedTuple):
    """What a point remembers."""

    preconsolidation_pressure: Annotated[float, StateVariable("Pa", "size p_c0 of the yield surface at rest")]
    gap: Annotated[float, StateVariable("1", "volumetric strain beyond the stress-free state; 0 while in contact")]
    inertial_number: Annotated[float, StateVariable("1", "plastic inertial number I of the last step")]


class Increment(NamedTuple):
    """A step in contact, before I is known."""

    start_pressure: float
    start_deviator: SymmetricTensor
    compression: float
    shear: SymmetricTensor
    size_at_rest: float
    dt: float


class Flow(NamedTuple):
    """A step with the yield surface of an assumed inertial number.

    size_at_rest  p_c0 at its end [Pa]
    assumed       inertial number of the surface on which it ends: the one asked for, but for what is left of F there
    found         inertial number of its plastic strain
    slope, compression_slope   derivatives of found and of the plastic volume strain with respect to assumed, for a
                  small step: where to try next
    """

    end: CamClayStep
    size_at_rest: float
    assumed: float
    found: float
    slope: float
    compression_slope: float


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """At rest: the yield surface through the initial stress, times OCR; without stress, at the edge of contact."""
    p = max(pressure(stress), parameters.stress_free_pressure)
    ratio = deviatoric_stress(stress) / (parameters.critical_state_ratio * p)
    through_stress = max(p * (1.0 + ratio * ratio), 2.0 * parameters.stress_free_pressure)
    return State(parameters.overconsolidation_ratio * through_stress, 0.0, 0.0)


def update(
    stress: SymmetricTensor,
    strain_rate: SymmetricTensor,
    density: float,
    state: State,
    parameters: Parameters,
    dt: float,
) -> tuple[SymmetricTensor, State]:
    """Close the gap if there is one, then the step with its own inertial number, and opening."""
    contact = after_closing(volumetric_strain_rate(strain_rate) * dt, scaled(deviator(strain_rate), dt), state.gap)
    if contact.gap > 0.0:
        return isotropic(0.0), State(state.preconsolidation_pressure, contact.gap, 0.0)

    smallest = parameters.stress_free_pressure
    increment = Increment(
        max(pressure(stress), smallest),
        deviator(stress),
        contact.compression,
        contact.shear,
        state.preconsolidation_pressure,
        dt,
    )
    flow = flow_in_parts(increment, state.inertial_number, parameters)
    end = flow.end
    size_at_rest = max(flow.size_at_rest, 2.0 * smallest / growth_of_surface(flow.assumed, parameters))
    if end.mean_pressure < smallest:
        gap = parameters.swelling_index * math.log(smallest / end.mean_pressure)
        return isotropic(0.0), State(size_at_rest, gap, 0.0)
    return assembled_stress(end.mean_pressure, end.deviator), State(size_at_rest, 0.0, flow.found)


@pointwise
def flow_in_parts(increment: Increment, guess: float, parameters: Parameters) -> Flow:
    """The whole step or, where its return jumps, the last of as many equal parts as it takes not to."""
    size = abs(increment.compression) + half_norm(increment.shear)
    parts = 1
    while True:
        flow, is_consistent = led_through(increment, parts, guess, parameters)
        if is_consistent or size <= SMALLEST_PART * parts:
            return flow
        parts *= 4


@pointwise
def led_through(increment: Increment, parts: int, guess: float, parameters: Parameters) -> tuple[Flow, bool]:
    """The last of equal parts of a step, and whether each had the inertial number of its own plastic strain."""
    start = CamClayStep(increment.start_pressure, increment.size_at_rest, increment.start_deviator, 0.0, 0.0)
    flow, is_consistent = Flow(start, increment.size_at_rest, 0.0, guess, 0.0, 0.0), True
    largest_mismatch = LARGEST_MISMATCH * sensitive_inertial_number(parameters)
    compression, shear, dt = increment.compression / parts, scaled(increment.shear, 1.0 / parts), increment.dt / parts
    for _ in range(parts):
        part = Increment(flow.end.mean_pressure, flow.end.deviator, compression, shear, flow.size_at_rest, dt)
        flow = consistent_flow(part, flow.found, parameters)
        is_consistent = is_consistent and abs(flow.found - flow.assumed) <= largest_mismatch
    return flow, is_consistent


@pointwise
def consistent_flow(increment: Increment, guess: float, parameters: Parameters) -> Flow:
    """The step whose plastic strain has the inertial number of its yield surface."""
    tolerance = TOLERANCE * sensitive_inertial_number(parameters)
    flow = flow_at(guess, increment, parameters, 0.0)
    slope = flow.slope
    lower, upper = 0.0, math.inf
    for _ in range(MAXIMUM_ITERATIONS):
        excess = flow.found - flow.assumed
        if abs(excess) <= tolerance:
            return flow
        if excess > 0.0:
            lower = flow.assumed
        else:
            if flow.found == 0.0:
                flow = onset_of_flow(flow.end, lower, increment, parameters)
                if flow.assumed == 0.0:
                    return flow
                slope = flow.slope
            upper = min(upper, flow.assumed)
        trial = flow.assumed + (flow.found - flow.assumed) / (1.0 - slope)
        if not lower < trial < upper:
            trial = 0.5 * (lower + upper) if upper < math.inf else flow.found
            slope = -math.inf
        if is_exhausted(flow.assumed, trial, upper - lower, slope, tolerance):
            return flow
        expected = flow.end.plastic_compression + flow.compression_slope * (trial - flow.assumed)
        new = flow_at(trial, increment, parameters, expected)
        is_stalled = abs(new.found - new.assumed) > 0.5 * abs(excess) and upper < math.inf
        # Without a slope the next trial leaves the bracket, which is then halved.
        slope = -math.inf if is_stalled else slope_between(flow, new)
        flow = new
    return flow


@pointwise
def is_exhausted(last: float, trial: float, width: float, slope: float, tolerance: float) -> bool:
    """Whether there is nothing between two trials, or a bracket that had to be halved is too narrow for a root."""
    return abs(trial - last) <= ROUND_OFF * trial or (slope == -math.inf and width <= tolerance)


@pointwise
def slope_between(last: Flow, new: Flow) -> float:
    """Slope of the inertial number found: of the secant or, from an elastic step, of the tangent."""
    if last.found == 0.0 or new.found == 0.0 or new.assumed == last.assumed:
        return new.slope
    return min(0.0, (new.found - last.found) / (new.assumed - last.assumed))


@pointwise
def onset_of_flow(elastic: CamClayStep, lower: float, increment: Increment, parameters: Parameters) -> Flow:
    """An elastic step with the inertial number whose yield surface it just reaches, at which flow sets in.

    (1) is solved in the logarithm of p_c0, which is convex in I, by Newton's method from below; `lower` is an inertial
    number at which the step is plastic, or 0.
    """
    p, s = elastic.mean_pressure, elastic.deviator
    q_squared = 1.5 * contraction(s, s)
    per_number = 1.0 / (parameters.dilation_inertial_number * plastic_index_of(parameters))
    number = lower
    for _ in range(MAXIMUM_ITERATIONS):
        m = steady_stress_ratio(number, parameters)
        reduced = q_squared / (m * m)
        excess = math.log((reduced / p + p) / increment.size_at_rest) - number * per_number
        if excess <= ROUND_OFF:
            break
        number += excess / (
            2.0 * reduced / (reduced + p * p) * slope_of_stress_ratio(number, parameters) / m + per_number
        )
    if number == 0.0:
        return Flow(elastic_end(elastic, increment.size_at_rest), increment.size_at_rest, 0.0, 0.0, 0.0, 0.0)
    size = increment.size_at_rest * growth_of_surface(number, parameters)
    return on_surface(elastic_end(elastic, size), size, number, increment, parameters)


@pointwise
def elastic_end(step: CamClayStep, size: float) -> CamClayStep:
    """An elastic step with a yield surface of another size p_c."""
    return CamClayStep(step.mean_pressure, size, step.deviator, 0.0, 0.0)


@pointwise
def flow_at(assumed: float, increment: Increment, parameters: Parameters, expected: float) -> Flow:
    """The Cam Clay step with the surface of an inertial number; `expected` as in `cam_clay_step`."""
    size = increment.size_at_rest * growth_of_surface(assumed, parameters)
    end = cam_clay_step(
        increment.start_pressure,
        increment.start_deviator,
        increment.compression,
        increment.shear,
        size,
        CamClay(
            steady_stress_ratio(assumed, parameters),
            parameters.compression_index,
            parameters.swelling_index,
            parameters.poisson_ratio,
        ),
        expected,
    )
    if end.plastic_shear == 0.0 and end.plastic_compression == 0.0:
        return Flow(end, increment.size_at_rest, assumed, 0.0, 0.0, 0.0)
    return on_surface(end, size, assumed, increment, parameters)


@pointwise
def on_surface(end: CamClayStep, size: float, assumed: float, increment: Increment, parameters: Parameters) -> Flow:
    """A step that ends on the yield surface, to the tolerance of its return; `size` is its p_c [Pa] at the start.

    Moving the surface by dF changes the multiplier by dF/(K F_p^2 + 3 G F_q^2 + H), H from hardening.
    """
    p, p_c, s = end.mean_pressure, end.preconsolidation_pressure, end.deviator
    m = steady_stress_ratio(assumed, parameters)
    plastic_index = plastic_index_of(parameters)
    reduced = 1.5 * contraction(s, s) / (m * m)

    f = reduced - p * (p_c - p)
    f_p, f_q = 2.0 * p - p_c, 2.0 * math.sqrt(reduced) / m
    f_i = -2.0 * reduced / m * slope_of_stress_ratio(assumed, parameters)
    f_i -= p * p_c / (parameters.dilation_inertial_number * plastic_index)
    bulk_modulus = p / parameters.swelling_index
    stiffness = bulk_modulus * f_p * f_p + p * p_c * f_p / plastic_index
    stiffness += 3.0 * shear_modulus(bulk_modulus, parameters.poisson_ratio) * f_q * f_q
    # Dry of the critical state softening can outweigh the rest.
    per_number = f_i / stiffness if stiffness > 0.0 else 0.0

    number_of_strain = inertial_number(1.0 / increment.dt, p, parameters.grain_diameter, parameters.grain_density)
    return Flow(
        end,
        increment.size_at_rest * (p_c / size),
        assumed - f / f_i,
        end.plastic_shear * number_of_strain,
        0.5 * math.sqrt(3.0) * f_q * per_number * number_of_strain,
        f_p * per_number,
    )


@pointwise
def steady_stress_ratio(number: float, parameters: Parameters) -> float:
    """M(I) = M_csl M_I (Eq. 2)."""
    slow = parameters.critical_state_ratio
    return slow + (parameters.dynamic_state_ratio - slow) * number / (parameters.friction_inertial_number + number)


@pointwise
def slope_of_stress_ratio(number: float, parameters: Parameters) -> float:
    """dM/dI."""
    constant = parameters.friction_inertial_number
    distance = constant + number
    return (parameters.dynamic_state_ratio - parameters.critical_state_ratio) * constant / (distance * distance)


@pointwise
def plastic_index_of(parameters: Parameters) -> float:
    """The slope of plastic compression, lambda - kappa."""
    return parameters.compression_index - parameters.swelling_index


@pointwise
def growth_of_surface(number: float, parameters: Parameters) -> float:
    """p_c/p_c0 (Eq. 7)."""
    exponent = number / (parameters.dilation_inertial_number * plastic_index_of(parameters))
    return math.exp(min(exponent, LARGEST_EXPONENT))


@pointwise
def sensitive_inertial_number(parameters: Parameters) -> float:
    """The inertial number over which the surface changes by about its own size."""
    return min(parameters.dilation_inertial_number * plastic_index_of(parameters), parameters.friction_inertial_number)


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of longitudinal elastic waves at the present pressure; zero where the point is open."""
    bulk_modulus = max(0.0, pressure(stress)) / parameters.swelling_index
    return longitudinal_wave_speed(bulk_modulus, shear_modulus(bulk_modulus, parameters.poisson_ratio), density)


def stored_energy(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Exact along isotropic paths; see `energy_of_cam_clay` for the deviator."""
    return energy_of_cam_clay(
        stress, density, parameters.swelling_index, parameters.poisson_ratio, parameters.stress_free_pressure
    )


def at_bound(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> bool:
    """The smallest yield surface, 2 `stress_free_pressure`."""
    return state.preconsolidation_pressure <= 2.0 * parameters.stress_free_pressure


def contradiction(parameters: Parameters) -> str:
    """Compression has to be softer than swelling, and friction may not fall with the shear rate."""
    if parameters.compression_index <= parameters.swelling_index:
        return (
            f"compression_index = {parameters.compression_index:g} must be larger than "
            f"swelling_index = {parameters.swelling_index:g}"
        )
    if parameters.dynamic_state_ratio < parameters.critical_state_ratio:
        return (
            f"dynamic_state_ratio = {parameters.dynamic_state_ratio:g} must not be smaller than "
            f"critical_state_ratio = {parameters.critical_state_ratio:g}"
        )
    return ""


def density_on_compression_line(mean_pressure: float, parameters: Parameters) -> float:
    """Bulk density [kg/m3] at rest, on the lines of `modified_cam_clay`."""
    ocr = parameters.overconsolidation_ratio
    log_volume = log_volume_of_figure_1(mean_pressure, ocr, parameters.compression_index, parameters.swelling_index)
    return parameters.grain_density / math.exp(log_volume)


PAPER = Parameters(
    critical_state_ratio=1.20,
    dynamic_state_ratio=2.16,
    friction_inertial_number=0.279,
    dilation_inertial_number=own_inertial_number_constant(0.5434 / 0.115),
    compression_index=0.040,
    swelling_index=0.008,
    poisson_ratio=0.2,
    overconsolidation_ratio=1.0,
    grain_density=2450.0,
    grain_diameter=0.005,
)
SOURCE = (
    "Table 1 of the paper behind both parents, I_M = I_0; I_v from sheared discrete elements, phi = 0.5434 - 0.115 I"
)

LAW = Law(
    name="mu_i_mcc",
    summary="mu(I)-MCC, the unified law: Cam Clay with an inertial-number-dependent critical state",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    stored_energy=stored_energy,
    at_bound=at_bound,
    contradiction=contradiction,
    parameter_sets={
        "paper": ParameterSet(PAPER, f"{SOURCE}; OCR = 1", density_on_compression_line),
        "paper_ocr4": ParameterSet(
            PAPER._replace(overconsolidation_ratio=4.0), f"{SOURCE}; OCR = 4", density_on_compression_line
        ),
    },
    hook_version=2,
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
