"""The return map of Modified Cam Clay, for every law whose yield surface is that ellipse at the end of a step.

    F = q^2/M^2 - p (p_c - p) <= 0
    d(eps^p) = dLambda [3/M^2 s - (2p - p_c)/3 1],   d(p_c)/p_c = d(eps_v^p)/(lambda - kappa),   dp/p = d(eps_v^e)/kappa

Over a step, p and p_c follow their exponential laws exactly, and G is the mean of G(p) along them. With
a = ln(2 p_trial/p_c) and B = 1/kappa + 1/(lambda - kappa), the critical state 2p = p_c is reached at the plastic volume
strain a/B. The strain is therefore written as (1 - theta) a/B with theta in (0, 1]: theta = 1 is the elastic trial
state, where F > 0, and theta -> 0 the critical state with q -> 0, where F < 0, on the dry side as on the wet one. The
root is bracketed from the start and found by Newton's method, near p = p_c in Lambda and elsewhere in the logarithm of
1 + 6 G Lambda/M^2, by which s shrinks, with bisection in theta wherever that leaves the bracket.

Source: Roscoe & Burland (1968); the integration is this project's. kappa and lambda are slopes in ln v - ln p.
"""

import math
from typing import NamedTuple

from grainlaw.materials import (
    SymmetricTensor,
    contraction,
    energy_of_shear,
    half_norm,
    pointwise,
    pressure,
    shear_modulus,
)
from grainlaw.materials.elementary import (
    exponential,
    exponential_near,
    growth_over,
    log_derivative_of_mean,
    log_ratio,
    mean_over_path,
)

TOLERANCE = 5e-11
MAXIMUM_ITERATIONS = 100
LONGEST_STEP = 30.0


class CamClay(NamedTuple):
    """The constants of the ellipse and of its hardening: M, lambda, kappa, nu [1]."""

    critical_state_ratio: float
    compression_index: float
    swelling_index: float
    poisson_ratio: float


class CamClayStep(NamedTuple):
    """The end of a step: p, p_c, s [Pa], and its plastic strain, sqrt(1/2 e^p:e^p) and eps_v^p [1]."""

    mean_pressure: float
    preconsolidation_pressure: float
    deviator: SymmetricTensor
    plastic_shear: float
    plastic_compression: float


class Trial(NamedTuple):
    """A step taken as elastic: its start, its strain, and where it ends.

    start_pressure  p at the start [Pa]
    start_ratio     s/p at the start [1]
    shear           deviatoric strain increment [1]
    growth          ln(p_trial/p) and
    inverse_growth  p/p_trial [1]
    log_pressure_ratio   ln(2 p_trial/p_c), positive on the wet side of the critical state, and
    critical_ratio  p_c/(2 p_trial) [1]
    """

    start_pressure: float
    start_ratio: SymmetricTensor
    shear: SymmetricTensor
    growth: float
    inverse_growth: float
    log_pressure_ratio: float
    critical_ratio: float


class YieldState(NamedTuple):
    """A point of the path from the elastic trial state (theta = 1) to the critical state (theta = 0).

    `newton_step` leads to the root along the tangent, in the multiplier 1/theta - 1.
    """

    mean_pressure: float
    preconsolidation_pressure: float
    modulus: float
    relaxation: float
    yield_function: float
    residual: float
    newton_step: float
    relaxation_rate: float


class Bracket(NamedTuple):
    """The theta to try next, and between which two the root lies."""

    theta: float
    below: float
    above: float


@pointwise
def cam_clay_step(
    start_pressure: float,
    start_deviator: SymmetricTensor,
    compression: float,
    shear: SymmetricTensor,
    preconsolidation_pressure: float,
    constants: CamClay,
    expected: float,
) -> CamClayStep:
    """One strain increment in contact (volumetric, compression-positive, and deviatoric), elastic or returned to F = 0.

    `expected` is the plastic volume strain to try first, 0 if nothing is known of it. The result is NaN if the
    iteration does not converge.
    """
    growth = compression / constants.swelling_index
    inverse_growth = exponential(-growth)
    p = start_pressure / inverse_growth
    modulus = shear_modulus(
        p * mean_over_path(growth, inverse_growth) / constants.swelling_index, constants.poisson_ratio
    )
    s = start_deviator + 2.0 * modulus * shear
    m = constants.critical_state_ratio
    if 1.5 * contraction(s, s) / (m * m) <= p * (preconsolidation_pressure - p):
        return CamClayStep(p, preconsolidation_pressure, s, 0.0, 0.0)
    trial = elastic_trial(start_pressure, start_deviator, compression, shear, preconsolidation_pressure, constants)
    new = return_to_yield_surface(trial, constants, expected)
    s = (start_deviator + 2.0 * new.modulus * shear) * (1.0 / (1.0 + new.relaxation))
    plastic_shear = 0.5 * half_norm(s) * new.relaxation / new.modulus
    plastic_compression = compression - constants.swelling_index * log_ratio(new.mean_pressure, start_pressure)
    return CamClayStep(new.mean_pressure, new.preconsolidation_pressure, s, plastic_shear, plastic_compression)


@pointwise
def total_slope(constants: CamClay) -> float:
    """1/kappa + 1/(lambda - kappa), the change of ln(p_c/p) with plastic volume strain."""
    return 1.0 / constants.swelling_index + 1.0 / (constants.compression_index - constants.swelling_index)


@pointwise
def elastic_trial(
    start_pressure: float,
    start_deviator: SymmetricTensor,
    compression: float,
    shear: SymmetricTensor,
    preconsolidation_pressure: float,
    constants: CamClay,
) -> Trial:
    """One strain increment taken as elastic, as the return starts from it."""
    growth = compression / constants.swelling_index
    inverse_growth = exponential(-growth)
    log_pressure_ratio = math.log(2.0 * start_pressure / preconsolidation_pressure) + growth
    critical_ratio = 0.5 * preconsolidation_pressure * inverse_growth / start_pressure
    start_ratio = start_deviator * (1.0 / start_pressure)
    return Trial(start_pressure, start_ratio, shear, growth, inverse_growth, log_pressure_ratio, critical_ratio)


@pointwise
def return_to_yield_surface(trial: Trial, constants: CamClay, expected: float) -> YieldState:
    """The state with F = 0 at the end of the step; NaN if the iteration does not converge."""
    bracket = first_bracket(trial.log_pressure_ratio)
    theta = (
        1.0 - expected * total_slope(constants) / trial.log_pressure_ratio if trial.log_pressure_ratio != 0.0 else 1.0
    )
    if 0.0 < theta < bracket.above:
        bracket = Bracket(theta, bracket.below, bracket.above)
    for _ in range(MAXIMUM_ITERATIONS):
        new = yield_state(bracket.theta, trial, constants)
        if is_on_yield_surface(new):
            return new
        bracket = updated_bracket(bracket, new)
    return YieldState(math.nan, math.nan, math.nan, math.nan, math.nan, math.nan, math.nan, math.nan)


@pointwise
def first_bracket(log_pressure_ratio: float) -> Bracket:
    """All of (0, 1], but for theta > ln 2 / a on the wet side, where p > p_c and no stress is on the ellipse."""
    above = min(1.0, math.log(2.0) / log_pressure_ratio) if log_pressure_ratio > 0.0 else 1.0
    return Bracket(above, 0.0, above)


@pointwise
def is_on_yield_surface(state: YieldState) -> bool:
    """Whether F = 0 to the tolerance, relative to p p_c."""
    return abs(state.yield_function) <= TOLERANCE * state.mean_pressure * state.preconsolidation_pressure


@pointwise
def updated_bracket(bracket: Bracket, state: YieldState) -> Bracket:
    """The bracket without the side of theta where the root is not, and Newton's theta or, outside it, the middle."""
    below, above = bracket.below, bracket.above
    if state.residual > 0.0:
        above = bracket.theta
    else:
        below = bracket.theta
    step = state.newton_step
    if state.relaxation_rate > 0.0:
        step = growth_over(min(step, LONGEST_STEP / state.relaxation_rate), state.relaxation_rate)
    theta = bracket.theta / (1.0 + step * bracket.theta)
    if not below < theta < above:
        theta = 0.5 * (below + above)
    return Bracket(theta, below, above)


@pointwise
def yield_state(theta: float, trial: Trial, constants: CamClay) -> YieldState:
    """Residual of F = 0 at theta, and the step of Newton's method in the multiplier 1/theta - 1.

    With W = p_c/p - 1 and N = 6 G Lambda/M^2 (by which the flow rule shrinks s), F = 0 reads
    (q_trial/(M p))^2 = (1 + N)^2 W. The relaxation rate is the derivative of ln(1 + N); 0 asks for a plain step.
    """
    m_squared = constants.critical_state_ratio * constants.critical_state_ratio
    kappa = constants.swelling_index
    elastic_share = 1.0 / (kappa * total_slope(constants))
    stiffness = shear_modulus(1.0 / kappa, constants.poisson_ratio)

    z = trial.log_pressure_ratio * theta
    critical_ratio = exponential_near(-z, -trial.log_pressure_ratio, trial.critical_ratio)
    log_growth = trial.growth - elastic_share * trial.log_pressure_ratio * (1.0 - theta)
    inverse_growth = exponential_near(-log_growth, -trial.growth, trial.inverse_growth)
    p = trial.start_pressure / inverse_growth
    w = 2.0 * critical_ratio - 1.0

    mean_modulus = stiffness * mean_over_path(log_growth, inverse_growth)
    at_start, sheared = inverse_growth * trial.start_ratio, 2.0 * mean_modulus * trial.shear
    s = at_start + sheared
    trial_squared = 1.5 / m_squared * contraction(s, s)
    slope = 3.0 / (total_slope(constants) * m_squared) * mean_modulus / mean_over_path(z, critical_ratio)
    n = slope * (1.0 - theta) / theta

    dz = -z * theta
    dlog_p = elastic_share * dz
    dlog_mean = log_derivative_of_mean(log_growth, inverse_growth)
    ds = dlog_mean * sheared - at_start
    dtrial_squared = 3.0 / m_squared * contraction(s, ds) * dlog_p
    dn = slope + n * (dlog_mean * dlog_p - log_derivative_of_mean(z, critical_ratio) * dz)
    dw = -(w + 1.0) * dz

    shrinkage = 1.0 / (1.0 + n)
    relaxed_squared = trial_squared * shrinkage * shrinkage
    # The logarithm of both sides is almost linear in ln(1 + N), however large a dry step; at W = 0 it does not exist.
    if w > 0.2:
        product = max(trial_squared, 1e-300) * w
        residual = 0.5 * log_ratio(max(relaxed_squared, 1e-300), w)
        relaxation_rate = dn * shrinkage
        derivative = 0.5 * (dtrial_squared * w - dw * trial_squared) - relaxation_rate * product
        newton_step = -residual * product / derivative
    else:
        residual = trial_squared - (1.0 + n) * (1.0 + n) * w
        relaxation_rate = 0.0
        newton_step = -residual / (dtrial_squared - (1.0 + n) * (2.0 * dn * w + (1.0 + n) * dw))
    yield_function = (relaxed_squared - w) * p * p
    p_c = 2.0 * critical_ratio * p
    return YieldState(p, p_c, mean_modulus * p, n, yield_function, residual, newton_step, relaxation_rate)


@pointwise
def energy_of_cam_clay(
    stress: SymmetricTensor, density: float, swelling_index: float, poisson_ratio: float, stress_free_pressure: float
) -> float:
    """Elastic energy per mass [J/kg] behind dp/p = d(eps_v)/kappa, from where contact begins, and of the deviator.

    With L = ln(p/p_0) the isotropic part is the work int p/rho d(eps_v) from p_0 to p,

        kappa/(1 - kappa) (p/rho - p_0/rho_0) = kappa p L/rho [1 - exp(-(1 - kappa) L)]/[(1 - kappa) L],

    exact along any isotropic path. The deviator counts with the modulus at the present pressure, s:s/(4 G rho). An
    elasticity with G proportional to p in rate form has no energy in the strict sense (Zytynski, Randolph, Nova & Wroth
    1978, Int. J. Numer. Anal. Meth. Geomech. 2): around a closed elastic cycle of shear and pressure it gains or loses
    a share of the shear part, which falls to the plastic work of a ledger.
    """
    p = pressure(stress)
    if p <= 0.0:
        return 0.0
    log_pressure = math.log(p / stress_free_pressure)
    growth = (1.0 - swelling_index) * log_pressure
    isotropic_part = swelling_index * p * log_pressure / density * mean_over_path(growth, exponential(-growth))
    return isotropic_part + energy_of_shear(stress, density, shear_modulus(p / swelling_index, poisson_ratio))


def log_volume_of_figure_1(
    mean_pressure: float, overconsolidation_ratio: float, compression_index: float, swelling_index: float
) -> float:
    """The logarithm of the specific volume at a pressure [Pa], on ln v = 0.021 - lambda ln(p/1 Pa) less swelling.

    The intercept is the one behind the paper's Figure 1(c); v < 1 there, as nominal as the figure.
    """
    log_volume = 0.021 - compression_index * math.log(overconsolidation_ratio * mean_pressure)
    return log_volume + swelling_index * math.log(overconsolidation_ratio)
