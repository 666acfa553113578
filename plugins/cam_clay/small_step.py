"""The return map of Modified Cam Clay for the small steps of a grid, without a branch, so that points go in parallel.

It solves the equations of `cam_clay`, where they are explained, from the elastic trial state by Newton's method in two
unknowns, the plastic volume strain x and the relaxation N = 6 G Lambda/M^2 of the deviator, with W = p_c/p:

    flow rule      x m - c N (2 - W) = 0,                c = M^2 kappa/(6 g)
    yield surface  (q_trial/(M p))^2 - (1 + N)^2 (W - 1) = 0

where G = (g/kappa) p m is the mean of G(p) over the step, and m the mean of p over its final value. A fixed number of
iterations is enough for steps as small as explicit dynamics takes. Where it is not, the result says so, and the
bracketed return has to be called.

Why there are two: a step of a collapse takes 2.9 times as long with the bracketed return alone, and 2.1 times with both
in one function. This one with substeps did not fail either (20,000 increments up to 20 %), but without `fused`, which
plain Python does not have, the step takes 7 to 11 % longer.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from grainlaw.materials import (
    SymmetricTensor,
    assembled_stress,
    contraction,
    deviator,
    pointwise,
    pressure,
    shear_modulus,
    volumetric_strain_rate,
)
from grainlaw.materials.elementary import fused
from grainlaw.plugins.cam_clay.return_map import TOLERANCE, CamClay, total_slope

# The largest exponent for which the power series below are exact to the last bits.
LARGEST_EXPONENT = 0.1
# Of the flow rule, as a strain; far below the round-off that the strain of a step carries.
STRAIN_TOLERANCE = 1e-13


class SmallStep(NamedTuple):
    """The end of a step, p, p_c, s [Pa], and whether it can be trusted."""

    mean_pressure: float
    preconsolidation_pressure: float
    deviator: SymmetricTensor
    succeeded: bool


class TrialInvariants(NamedTuple):
    """What the residuals need of the elastic trial state.

    growth       ln(p_trial/p) of the elastic trial
    inverse_growth   p/p_trial
    ratio        p_c/p_trial
    q_squared_0, q_squared_1, q_squared_2   coefficients of (q_trial/(M p))^2 in p_start/p and m
    """

    growth: float
    inverse_growth: float
    ratio: float
    q_squared_0: float
    q_squared_1: float
    q_squared_2: float


class Iterate(NamedTuple):
    """The unknowns x and N, the residuals of flow rule and yield surface, and what they were made from."""

    plastic_compression: float
    relaxation: float
    of_flow: float
    of_yield: float
    inverse_growth: float
    mean: float
    ratio: float
    growth: float


@pointwise
def cam_clay_small_step(
    start_pressure: float,
    start_deviator: SymmetricTensor,
    compression: float,
    shear: SymmetricTensor,
    preconsolidation_pressure: float,
    constants: CamClay,
) -> SmallStep:
    """One strain increment in contact, elastic or returned to F = 0, if it is small enough for that."""
    trial, sheared = trial_invariants(
        start_pressure, start_deviator, compression, shear, preconsolidation_pressure, constants
    )
    elastic = residuals_at(0.0, 0.0, trial, constants)
    first = newton_step(elastic, trial, constants)
    second = newton_step(first, trial, constants)
    last = newton_step(newton_step(second, trial, constants), trial, constants)

    yields = elastic.of_yield > 0.0
    relaxation = last.relaxation if yields else 0.0
    end_inverse_growth = last.inverse_growth if yields else trial.inverse_growth
    mean = last.mean if yields else elastic.mean
    ratio = last.ratio if yields else trial.ratio
    p = start_pressure / end_inverse_growth
    s = (start_deviator + p * mean * sheared) * (1.0 / (1.0 + relaxation))
    error = max(abs(last.of_yield) - TOLERANCE * last.ratio, abs(last.of_flow) - STRAIN_TOLERANCE)
    exponent = max(abs(last.growth), abs(last.plastic_compression) * total_slope(constants))
    is_root = error <= 0.0 and exponent <= LARGEST_EXPONENT and last.relaxation >= 0.0
    succeeded = abs(trial.growth) <= LARGEST_EXPONENT and (is_root or not yields)
    return SmallStep(p, ratio * p, s, succeeded)


def small_step_of(state_class: type[Any], constants_of: Callable[[Any], CamClay]) -> Callable[..., Any]:
    """`Law.small_step` of modified Cam Clay, for points that are in contact and stay so."""

    def small_step(
        stress: SymmetricTensor,
        strain_rate: SymmetricTensor,
        density: float,
        state: Any,
        parameters: Any,
        dt: float,
    ) -> tuple[SymmetricTensor, Any, bool]:
        smallest = parameters.stress_free_pressure
        start_pressure = pressure(stress)
        new = cam_clay_small_step(
            max(start_pressure, smallest),
            deviator(stress),
            volumetric_strain_rate(strain_rate) * dt,
            dt * deviator(strain_rate),
            state.preconsolidation_pressure,
            constants_of(parameters),
        )
        in_contact = min(start_pressure, new.mean_pressure, 0.5 * new.preconsolidation_pressure) >= smallest
        succeeded = new.succeeded and in_contact and state.opening_strain == 0.0
        new_state = state_class(new.preconsolidation_pressure, 0.0)
        return assembled_stress(new.mean_pressure, new.deviator), new_state, succeeded

    return small_step


@pointwise
def trial_invariants(
    start_pressure: float,
    start_deviator: SymmetricTensor,
    compression: float,
    shear: SymmetricTensor,
    preconsolidation_pressure: float,
    constants: CamClay,
) -> tuple[TrialInvariants, SymmetricTensor]:
    """The elastic trial state, and the strain by which p m moves the deviator, 2 g/kappa times the shear."""
    m_squared = constants.critical_state_ratio * constants.critical_state_ratio
    stiffness = shear_modulus(inverse_swelling_index(constants), constants.poisson_ratio)
    inverse_pressure = 1.0 / start_pressure
    growth = compression * inverse_swelling_index(constants)
    inverse_growth = exponential_series(-growth)
    at_start = inverse_pressure * start_deviator
    sheared = 2.0 * stiffness * shear
    trial = TrialInvariants(
        growth,
        inverse_growth,
        preconsolidation_pressure * inverse_pressure * inverse_growth,
        1.5 / m_squared * contraction(at_start, at_start),
        3.0 / m_squared * contraction(at_start, sheared),
        1.5 / m_squared * contraction(sheared, sheared),
    )
    return trial, sheared


@pointwise
def residuals_at(plastic_compression: float, relaxation: float, trial: TrialInvariants, constants: CamClay) -> Iterate:
    """The residuals of both equations at given unknowns."""
    shrinking = plastic_compression * inverse_swelling_index(constants)
    growth = trial.growth - shrinking
    inverse_growth = trial.inverse_growth * exponential_series(shrinking)
    mean = mean_over_path_series(growth)
    ratio = trial.ratio * exponential_series(plastic_compression * total_slope(constants))
    grown = 1.0 + relaxation
    of_flow = fused(plastic_compression, mean, flow_factor(constants) * relaxation * (ratio - 2.0))
    of_yield = fused(grown * grown, 1.0 - ratio, q_squared_at(inverse_growth, mean, trial))
    return Iterate(plastic_compression, relaxation, of_flow, of_yield, inverse_growth, mean, ratio, growth)


@pointwise
def newton_step(last: Iterate, trial: TrialInvariants, constants: CamClay) -> Iterate:
    """One step of Newton's method for both unknowns."""
    d_mean = slope_of_mean(last.growth) * inverse_swelling_index(constants)
    d_ratio = total_slope(constants) * last.ratio
    d_q_squared = slope_of_q_squared(last.inverse_growth, last.mean, d_mean, trial, constants)
    grown = 1.0 + last.relaxation
    factor = flow_factor(constants)
    flow_x = fused(factor * last.relaxation, d_ratio, fused(last.plastic_compression, d_mean, last.mean))
    flow_n = factor * (last.ratio - 2.0)
    yield_x = fused(-grown * grown, d_ratio, d_q_squared)
    yield_n = 2.0 * grown * (1.0 - last.ratio)
    scale = -1.0 / fused(flow_x, yield_n, -flow_n * yield_x)
    x = fused(fused(last.of_flow, yield_n, -flow_n * last.of_yield), scale, last.plastic_compression)
    n = fused(fused(flow_x, last.of_yield, -last.of_flow * yield_x), scale, last.relaxation)
    return residuals_at(x, n, trial, constants)


@pointwise
def q_squared_at(inverse_growth: float, mean: float, trial: TrialInvariants) -> float:
    """(q_trial/(M p))^2."""
    linear = fused(trial.q_squared_0, inverse_growth, trial.q_squared_1 * mean)
    return fused(inverse_growth, linear, trial.q_squared_2 * mean * mean)


@pointwise
def slope_of_q_squared(
    inverse_growth: float, mean: float, d_mean: float, trial: TrialInvariants, constants: CamClay
) -> float:
    """The same, per plastic volume strain; `d_mean` is that of m."""
    d_inverse_growth = inverse_growth * inverse_swelling_index(constants)
    of_growth = fused(2.0 * trial.q_squared_0, inverse_growth, trial.q_squared_1 * mean)
    of_mean = fused(trial.q_squared_1, inverse_growth, 2.0 * trial.q_squared_2 * mean)
    return fused(of_growth, d_inverse_growth, of_mean * d_mean)


@pointwise
def slope_of_mean(growth: float) -> float:
    """How m falls with the growth, by the first terms of its power series."""
    return fused(growth, fused(0.125, growth, -1.0 / 3.0), 0.5)


@pointwise
def flow_factor(constants: CamClay) -> float:
    """The factor c between x m and N (2 - W)."""
    m_squared = constants.critical_state_ratio * constants.critical_state_ratio
    return m_squared / (6.0 * shear_modulus(inverse_swelling_index(constants), constants.poisson_ratio))


@pointwise
def inverse_swelling_index(constants: CamClay) -> float:
    """1/kappa, the same for all points: a product with it takes a third of the time of a division by kappa."""
    return 1.0 / constants.swelling_index


@pointwise
def exponential_series(x: float) -> float:
    """exp(x) by its power series, for |x| <= LARGEST_EXPONENT."""
    square = x * x
    low, middle = fused(x, 0.5, 1.0), fused(x, 1.0 / 24.0, 1.0 / 6.0)
    high = fused(square, fused(x, 1.0 / 40320.0, 1.0 / 5040.0), fused(x, 1.0 / 720.0, 1.0 / 120.0))
    return fused(x, fused(square, fused(square, high, middle), low), 1.0)


@pointwise
def mean_over_path_series(growth: float) -> float:
    """(1 - exp(-growth))/growth by its power series, for |growth| <= LARGEST_EXPONENT."""
    x = -growth
    square = x * x
    low, middle = fused(x, 0.5, 1.0), fused(x, 1.0 / 24.0, 1.0 / 6.0)
    high = fused(square, fused(x, 1.0 / 40320.0, 1.0 / 5040.0), fused(x, 1.0 / 720.0, 1.0 / 120.0))
    return fused(square, fused(square, high, middle), low)
