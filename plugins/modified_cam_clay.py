"""Modified Cam Clay (MCC), with exponential elasticity integrated exactly and a gap for opened points.

    F = q^2/M^2 - p (p_c - p) <= 0                                                           (paper Eq. 7)
    d(eps^p) = dLambda [3/M^2 s - (2p - p_c)/3 1], so d(eps_v^p) = dLambda (2p - p_c)         (paper Eq. 8)
    dp_c/p_c = d(eps_v^p)/(lambda - kappa),   dp/p = d(eps_v^e)/kappa                         (paper Eq. 9)
    K = p/kappa,   G = 3 (1 - 2 nu) / (2 (1 + nu)) K                                          (paper Eq. 10)

The printed Eq. 8 lacks the factor 1/3, without which it is not the gradient of F.

Return mapping. Over a step, p and p_c follow their exponential laws exactly, and G is the mean of G(p) along them.
With a = ln(2 p_trial/p_c) and B = 1/kappa + 1/(lambda - kappa), the critical state 2p = p_c is reached at the plastic
volume strain a/B. The strain is therefore written as (1 - theta) a/B with theta in (0, 1]: theta = 1 is the elastic
trial state, where F > 0, and theta -> 0 the critical state with q -> 0, where F < 0, on the dry side as on the wet one.
The root is bracketed from the start and found by Newton's method, near p = p_c in Lambda and elsewhere in the logarithm
of 1 + 6 G Lambda/M^2, by which s shrinks, with bisection in theta wherever that leaves the bracket.

Grains carry no tension. Where the pressure would fall below `stress_free_pressure` the point opens: its stress is zero
and `gap` keeps the volumetric strain since, so that pressure returns only when the gap has closed.

Source: paper = "A comparative study of granular solid-like and fluid-like constitutive laws", Eqs. 7-10, Table 1; MCC
after Roscoe & Burland (1968). kappa and lambda are slopes in ln v - ln p.
Conventions: tensors tension-positive; p, eps_v compression-positive; q = sqrt(3/2 s:s).
Valid for quasi-static deformation: the law knows no rate.
"""

import math
from typing import Annotated, Any, NamedTuple

from materials import (
    Law,
    Parameter,
    ParameterSet,
    StateVariable,
    SymmetricTensor,
    added,
    after_closing,
    assembled_stress,
    contraction,
    deviator,
    deviatoric_stress,
    hookimpl,
    isotropic,
    longitudinal_wave_speed,
    pointwise,
    pressure,
    scaled,
    shear_modulus,
    volumetric_strain_rate,
)

TOLERANCE = 1e-11
MAXIMUM_ITERATIONS = 100
LONGEST_STEP = 30.0


class Parameters(NamedTuple):
    """Material constants."""

    critical_state_ratio: Annotated[float, Parameter("1", "slope M = q/p of the critical state line", "(0, inf)")]
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
    stress_free_pressure: Annotated[
        float, Parameter("Pa", "pressure below which grains are taken to lose contact", "(0, inf)")
    ] = 1.0


class State(NamedTuple):
    """What a point remembers."""

    preconsolidation_pressure: Annotated[float, StateVariable("Pa", "size p_c of the yield surface")]
    gap: Annotated[float, StateVariable("1", "volumetric strain beyond the stress-free state; 0 while in contact")]


class YieldState(NamedTuple):
    """A point of the path from the elastic trial state (theta = 1) to the critical state (theta = 0)."""

    mean_pressure: float
    preconsolidation_pressure: float
    modulus: float
    relaxation: float
    yield_function: float
    residual: float
    derivative: float
    relaxation_rate: float


class Bracket(NamedTuple):
    """The theta to try next, and between which two the root lies."""

    theta: float
    below: float
    above: float


def initial_state(stress: SymmetricTensor, density: float, parameters: Parameters) -> State:
    """The yield surface through the initial stress, times OCR; a stress-free point starts at the edge of contact."""
    p = max(pressure(stress), parameters.stress_free_pressure)
    q = deviatoric_stress(stress)
    m = parameters.critical_state_ratio
    through_stress = p + q * q / (m * m * p)
    return State(parameters.overconsolidation_ratio * max(through_stress, 2.0 * parameters.stress_free_pressure), 0.0)


def update(
    stress: SymmetricTensor,
    strain_rate: SymmetricTensor,
    density: float,
    state: State,
    parameters: Parameters,
    dt: float,
) -> tuple[SymmetricTensor, State]:
    """Close the gap if there is one, then the elastic trial step, the return to F = 0, and opening."""
    contact = after_closing(volumetric_strain_rate(strain_rate) * dt, scaled(deviator(strain_rate), dt), state.gap)
    if contact.gap > 0.0:
        return isotropic(0.0), State(state.preconsolidation_pressure, contact.gap)

    start_pressure = max(pressure(stress), parameters.stress_free_pressure)
    start_deviator = deviator(stress)
    new_pressure, new_preconsolidation, new_deviator = cam_clay_step(
        start_pressure,
        start_deviator,
        contact.compression,
        contact.shear,
        state.preconsolidation_pressure,
        parameters,
    )
    smallest = parameters.stress_free_pressure
    new_preconsolidation = max(new_preconsolidation, 2.0 * smallest)
    if new_pressure < smallest:
        gap = parameters.swelling_index * math.log(smallest / new_pressure)
        return isotropic(0.0), State(new_preconsolidation, gap)
    return assembled_stress(new_pressure, new_deviator), State(new_preconsolidation, 0.0)


@pointwise
def cam_clay_step(
    start_pressure: float,
    start_deviator: SymmetricTensor,
    compression: float,
    shear: SymmetricTensor,
    preconsolidation_pressure: float,
    parameters: Parameters,
) -> tuple[float, float, SymmetricTensor]:
    """One strain increment in contact: the new p, p_c and s."""
    growth = compression / parameters.swelling_index
    factor = math.exp(growth)
    p = start_pressure * factor
    modulus = shear_modulus(p * mean_over_path(growth, factor) / parameters.swelling_index, parameters.poisson_ratio)
    s = added(start_deviator, scaled(shear, 2.0 * modulus))
    m = parameters.critical_state_ratio
    if 1.5 * contraction(s, s) / (m * m) <= p * (preconsolidation_pressure - p):
        return p, preconsolidation_pressure, s
    new = return_to_yield_surface(start_pressure, start_deviator, growth, shear, preconsolidation_pressure, parameters)
    s = added(start_deviator, scaled(shear, 2.0 * new.modulus))
    return new.mean_pressure, new.preconsolidation_pressure, scaled(s, 1.0 / (1.0 + new.relaxation))


@pointwise
def mean_over_path(growth: float, factor: float) -> float:
    """Mean over final value of what grows by factor = exp(growth): (1 - exp(-growth))/growth."""
    if abs(growth) < 1e-2:
        return 1.0 - growth / 2.0 * (1.0 - growth / 3.0 * (1.0 - growth / 4.0 * (1.0 - growth / 5.0)))
    return (1.0 - 1.0 / factor) / growth


@pointwise
def log_derivative_of_mean(growth: float, factor: float) -> float:
    """Derivative of ln(mean_over_path) with respect to growth."""
    if abs(growth) < 1e-2:
        return -0.5 + growth / 12.0
    return 1.0 / (factor - 1.0) - 1.0 / growth


@pointwise
def return_to_yield_surface(
    start_pressure: float,
    start_deviator: SymmetricTensor,
    growth: float,
    shear: SymmetricTensor,
    preconsolidation_pressure: float,
    parameters: Parameters,
) -> YieldState:
    """The state with F = 0 at the end of the step; NaN if the iteration does not converge."""
    wetness = math.log(2.0 * start_pressure / preconsolidation_pressure) + growth
    bracket = first_bracket(wetness)
    for _ in range(MAXIMUM_ITERATIONS):
        new = yield_state(bracket.theta, start_pressure, start_deviator, growth, wetness, shear, parameters)
        if is_on_yield_surface(new):
            return new
        bracket = narrowed(bracket, new)
    return YieldState(math.nan, math.nan, math.nan, math.nan, math.nan, math.nan, math.nan, math.nan)


@pointwise
def first_bracket(wetness: float) -> Bracket:
    """All of (0, 1], but for theta > ln 2 / a on the wet side, where p > p_c and no stress is on the ellipse."""
    above = min(1.0, math.log(2.0) / wetness) if wetness > 0.0 else 1.0
    return Bracket(above, 0.0, above)


@pointwise
def is_on_yield_surface(state: YieldState) -> bool:
    """Whether F = 0 to the tolerance, relative to p p_c."""
    return abs(state.yield_function) <= TOLERANCE * state.mean_pressure * state.preconsolidation_pressure


@pointwise
def narrowed(bracket: Bracket, state: YieldState) -> Bracket:
    """The bracket without the side of theta where the root is not, and Newton's theta or, outside it, the middle."""
    below, above = bracket.below, bracket.above
    if state.residual > 0.0:
        above = bracket.theta
    else:
        below = bracket.theta
    step = -state.residual / state.derivative
    if state.relaxation_rate > 0.0:
        step = math.expm1(min(step * state.relaxation_rate, LONGEST_STEP)) / state.relaxation_rate
    theta = 1.0 / (1.0 / bracket.theta + step)
    if not below < theta < above:
        theta = 0.5 * (below + above)
    return Bracket(theta, below, above)


@pointwise
def yield_state(
    theta: float,
    start_pressure: float,
    start_deviator: SymmetricTensor,
    growth: float,
    wetness: float,
    shear: SymmetricTensor,
    parameters: Parameters,
) -> YieldState:
    """Residual of F = 0 at theta, and its derivative with respect to the multiplier 1/theta - 1.

    With W = p_c/p - 1 and N = 6 G Lambda/M^2 (by which the flow rule shrinks s), F = 0 reads
    (q_trial/(M p))^2 = (1 + N)^2 W. The relaxation rate is the derivative of ln(1 + N); 0 asks for a plain step.
    """
    m_squared = parameters.critical_state_ratio * parameters.critical_state_ratio
    kappa = parameters.swelling_index
    total_slope = 1.0 / kappa + 1.0 / (parameters.compression_index - kappa)
    elastic_share = 1.0 / (kappa * total_slope)
    stiffness = shear_modulus(1.0 / kappa, parameters.poisson_ratio)

    z = wetness * theta
    z_factor = math.exp(z)
    log_growth = growth - elastic_share * wetness * (1.0 - theta)
    factor = math.exp(log_growth)
    p = start_pressure * factor
    p_c = 2.0 * p / z_factor
    w = p_c / p - 1.0

    mean_modulus = stiffness * mean_over_path(log_growth, factor)
    s = added(scaled(start_deviator, 1.0 / p), scaled(shear, 2.0 * mean_modulus))
    trial_squared = 1.5 * contraction(s, s) / m_squared
    slope = 3.0 * mean_modulus / (mean_over_path(z, z_factor) * total_slope * m_squared)
    n = slope * (1.0 / theta - 1.0)

    dz = -z * theta
    dlog_p = elastic_share * dz
    dlog_mean = log_derivative_of_mean(log_growth, factor)
    ds = added(scaled(start_deviator, -1.0 / p), scaled(shear, 2.0 * mean_modulus * dlog_mean))
    dtrial_squared = 3.0 * contraction(s, ds) / m_squared * dlog_p
    dn = slope + n * (dlog_mean * dlog_p - log_derivative_of_mean(z, z_factor) * dz)
    dw = -(w + 1.0) * dz

    relaxed_squared = trial_squared / ((1.0 + n) * (1.0 + n))
    # The logarithm of both sides is almost linear in ln(1 + N), however large a dry step; at W = 0 it does not exist.
    if w > 0.2:
        residual = 0.5 * math.log(max(relaxed_squared, 1e-300) / w)
        relaxation_rate = dn / (1.0 + n)
        derivative = 0.5 * (dtrial_squared / max(trial_squared, 1e-300) - dw / w) - relaxation_rate
    else:
        residual = trial_squared - (1.0 + n) * (1.0 + n) * w
        relaxation_rate = 0.0
        derivative = dtrial_squared - (1.0 + n) * (2.0 * dn * w + (1.0 + n) * dw)
    yield_function = (relaxed_squared - w) * p * p
    return YieldState(p, p_c, mean_modulus * p, n, yield_function, residual, derivative, relaxation_rate)


def sound_speed(stress: SymmetricTensor, density: float, state: State, parameters: Parameters) -> float:
    """Speed of longitudinal elastic waves at the present pressure; zero where the point is open."""
    bulk_modulus = max(0.0, pressure(stress)) / parameters.swelling_index
    return longitudinal_wave_speed(bulk_modulus, shear_modulus(bulk_modulus, parameters.poisson_ratio), density)


def contradiction(parameters: Parameters) -> str:
    """Compression has to be softer than swelling."""
    if parameters.compression_index > parameters.swelling_index:
        return ""
    return (
        f"compression_index = {parameters.compression_index:g} must be larger than "
        f"swelling_index = {parameters.swelling_index:g}"
    )


def density_on_compression_line(mean_pressure: float, parameters: Parameters) -> float:
    """Bulk density [kg/m3] at rest, from the isotropic compression line ln v = 0.021 - lambda ln(p/1 Pa) and swelling.

    The intercept is the one behind the published Figure 1(c); v < 1 there, as nominal as the figure.
    """
    ocr = parameters.overconsolidation_ratio
    log_volume = 0.021 - parameters.compression_index * math.log(ocr * mean_pressure)
    log_volume += parameters.swelling_index * math.log(ocr)
    return parameters.grain_density / math.exp(log_volume)


PAPER = Parameters(
    critical_state_ratio=1.20,
    compression_index=0.040,
    swelling_index=0.008,
    poisson_ratio=0.2,
    overconsolidation_ratio=1.0,
    grain_density=2450.0,
)

LAW = Law(
    name="modified_cam_clay",
    summary="Modified Cam Clay critical-state plasticity with exact exponential elasticity and gap tracking",
    parameters=Parameters,
    state=State,
    initial_state=initial_state,
    update=update,
    sound_speed=sound_speed,
    contradiction=contradiction,
    parameter_sets={
        "paper": ParameterSet(PAPER, "Table 1, OCR = 1", density_on_compression_line),
        "paper_ocr4": ParameterSet(
            PAPER._replace(overconsolidation_ratio=4.0), "Table 1, OCR = 4", density_on_compression_line
        ),
    },
)


@hookimpl
def grainlaw_materials() -> list[Any]:
    """Register this law."""
    return [LAW]
