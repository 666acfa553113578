"""The return map of `flowing_cam_clay_step` for the small steps of a grid, without a branch.

As in `cam_clay_small_step`, Newton's method in the plastic volume strain x and the relaxation N of the deviator, here
with M = M(I) and W = p_c/p of the surface that moves with I:

    flow rule      x m - c (M/M_csl)^2 N (2 - W) = 0
    yield surface  (q_trial/(M_csl p))^2 - (M/M_csl)^2 (1 + N)^2 (W - 1) = 0

The inertial number follows from the unknowns, since the plastic shear is s N/(2 G):

    I = b N/(1 + N) q_trial/(M_csl p) sqrt(p_start/p)/m,    b = M_csl kappa d_p sqrt(rho_p/p_start)/(2 sqrt(3) g dt)

The iteration begins where the inertial number is that of the step before; from rest, the exponential growth of the
surface with I would lead it far beyond. A fixed number of iterations is enough for steps as small as explicit dynamics
takes. Where it is not, the result says so, and `flowing_cam_clay_step` has to be called.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from grainlaw.materials import (
    SymmetricTensor,
    assembled_stress,
    deviator,
    pointwise,
    pressure,
    shear_modulus,
    volumetric_strain_rate,
)
from grainlaw.materials.elementary import fused
from grainlaw.plugins.cam_clay.rate_dependent import (
    FlowingCamClay,
    growth_per_number,
    slope_of_stress_ratio,
    steady_stress_ratio,
)
from grainlaw.plugins.cam_clay.return_map import TOLERANCE, CamClay, total_slope
from grainlaw.plugins.cam_clay.small_step import (
    LARGEST_EXPONENT,
    STRAIN_TOLERANCE,
    TrialInvariants,
    exponential_series,
    flow_factor,
    inverse_swelling_index,
    mean_over_path_series,
    q_squared_at,
    slope_of_mean,
    slope_of_q_squared,
    trial_invariants,
)

# exp(x) is that of a small part of x, squared this often.
SQUARINGS = 8
PARTS = 2.0**SQUARINGS
# Below this, (q/(M p))^2 is taken for zero.
SMALLEST_Q_SQUARED = 1e-30
# Of N/(1 + N) to begin with.
LARGEST_SHARE = 0.5


class SmallFlowingStep(NamedTuple):
    """The end of a step: p, p_c0, s [Pa], I, p_c/p, and whether it can be trusted."""

    mean_pressure: float
    size_at_rest: float
    deviator: SymmetricTensor
    inertial_number: float
    ratio: float
    succeeded: bool


class FlowingIterate(NamedTuple):
    """The unknowns x and N, the residuals of flow rule and yield surface, and what they were made from.

    q_squared      (q_trial/(M_csl p))^2
    inverse_grown  1/(1 + N)
    per_share      I over N/(1 + N)
    ratio_at_rest  p_c0/p
    ratio          p_c/p
    slope          M/M_csl
    """

    plastic_compression: float
    relaxation: float
    of_flow: float
    of_yield: float
    inverse_growth: float
    mean: float
    growth: float
    q_squared: float
    inverse_grown: float
    per_share: float
    ratio_at_rest: float
    ratio: float
    slope: float
    inertial_number: float


@pointwise
def flowing_cam_clay_small_step(
    start_pressure: float,
    start_deviator: SymmetricTensor,
    compression: float,
    shear: SymmetricTensor,
    size_at_rest: float,
    expected_inertial_number: float,
    dt: float,
    constants: FlowingCamClay,
) -> SmallFlowingStep:
    """One strain increment in contact, if it is small enough for that; arguments as of `flowing_cam_clay_step`."""
    trial, sheared = trial_invariants(
        start_pressure, start_deviator, compression, shear, size_at_rest, at_rest(constants)
    )
    number = number_factor(dt, constants) * math.sqrt(1.0 / start_pressure)
    elastic = residuals_in_flow(0.0, 0.0, trial, number, constants)
    first = first_iterate(elastic, expected_inertial_number, trial, number, constants)
    second = newton_step_in_flow(first, trial, number, constants)
    third = newton_step_in_flow(second, trial, number, constants)
    fourth = newton_step_in_flow(third, trial, number, constants)
    last = newton_step_in_flow(fourth, trial, number, constants)

    yields = elastic.of_yield > 0.0
    inverse_grown = last.inverse_grown if yields else 1.0
    inverse_growth = last.inverse_growth if yields else elastic.inverse_growth
    mean = last.mean if yields else elastic.mean
    ratio_at_rest = last.ratio_at_rest if yields else elastic.ratio_at_rest
    ratio = last.ratio if yields else elastic.ratio
    p = start_pressure / inverse_growth
    s = inverse_grown * (start_deviator + p * mean * sheared)
    succeeded = is_short(elastic, constants) and (not yields or (is_root(last) and is_short(last, constants)))
    return SmallFlowingStep(p, ratio_at_rest * p, s, last.inertial_number if yields else 0.0, ratio, succeeded)


def small_flowing_step_of(state_class: type[Any], constants_of: Callable[[Any], FlowingCamClay]) -> Callable[..., Any]:
    """`Law.small_step` of mu(I)-MCC, for points that are in contact and stay so."""

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
        new = flowing_cam_clay_small_step(
            max(start_pressure, smallest),
            deviator(stress),
            volumetric_strain_rate(strain_rate) * dt,
            dt * deviator(strain_rate),
            state.preconsolidation_pressure,
            state.inertial_number,
            dt,
            constants_of(parameters),
        )
        in_contact = min(start_pressure, new.mean_pressure, 0.5 * new.ratio * new.mean_pressure) >= smallest
        succeeded = new.succeeded and in_contact and state.opening_strain == 0.0
        new_state = state_class(new.size_at_rest, 0.0, new.inertial_number)
        return assembled_stress(new.mean_pressure, new.deviator), new_state, succeeded

    return small_step


@pointwise
def first_iterate(
    elastic: FlowingIterate, expected: float, trial: TrialInvariants, number: float, constants: FlowingCamClay
) -> FlowingIterate:
    """Where the inertial number is the expected one, as nearly as is known before there is plastic strain."""
    share = min(expected / elastic.per_share, LARGEST_SHARE)
    relaxation = share / (1.0 - share)
    slope = steady_stress_ratio(expected, constants) / constants.critical_state_ratio
    ratio = elastic.ratio_at_rest * growth_by_squaring(expected, constants)
    x = flow_factor(at_rest(constants)) * slope * slope * relaxation * (2.0 - ratio)
    return residuals_in_flow(x, relaxation, trial, number, constants)


@pointwise
def residuals_in_flow(
    plastic_compression: float, relaxation: float, trial: TrialInvariants, number: float, constants: FlowingCamClay
) -> FlowingIterate:
    """The residuals of both equations at given unknowns; `number` is b."""
    shrinking = plastic_compression * inverse_swelling_index(at_rest(constants))
    growth = trial.growth - shrinking
    inverse_growth = trial.inverse_growth * exponential_series(shrinking)
    mean = mean_over_path_series(growth)
    q_squared = max(q_squared_at(inverse_growth, mean, trial), SMALLEST_Q_SQUARED)
    grown = 1.0 + relaxation
    inverse_grown = 1.0 / grown
    per_share = number * math.sqrt(q_squared * inverse_growth) / mean
    inertial_number = max(0.0, per_share * relaxation * inverse_grown)
    ratio_at_rest = trial.ratio * exponential_series(plastic_compression * total_slope(at_rest(constants)))
    ratio = ratio_at_rest * growth_by_squaring(inertial_number, constants)
    slope = steady_stress_ratio(inertial_number, constants) * (1.0 / constants.critical_state_ratio)
    square = slope * slope
    of_flow = fused(plastic_compression, mean, flow_factor(at_rest(constants)) * square * relaxation * (ratio - 2.0))
    of_yield = fused(square * grown * grown, 1.0 - ratio, q_squared)
    return FlowingIterate(
        plastic_compression,
        relaxation,
        of_flow,
        of_yield,
        inverse_growth,
        mean,
        growth,
        q_squared,
        inverse_grown,
        per_share,
        ratio_at_rest,
        ratio,
        slope,
        inertial_number,
    )


@pointwise
def newton_step_in_flow(
    last: FlowingIterate, trial: TrialInvariants, number: float, constants: FlowingCamClay
) -> FlowingIterate:
    """One step of Newton's method for both unknowns."""
    d_shrinking = inverse_swelling_index(at_rest(constants))
    d_mean = slope_of_mean(last.growth) * d_shrinking
    d_q_squared = slope_of_q_squared(last.inverse_growth, last.mean, d_mean, trial, at_rest(constants))
    number_x = last.inertial_number * (0.5 * d_q_squared / last.q_squared + 0.5 * d_shrinking - d_mean / last.mean)
    number_n = last.per_share * last.inverse_grown * last.inverse_grown
    ratio_x = last.ratio * fused(number_x, growth_per_number(constants), total_slope(at_rest(constants)))
    ratio_n = last.ratio * number_n * growth_per_number(constants)
    square = last.slope * last.slope
    d_slope = slope_of_stress_ratio(last.inertial_number, constants) * (1.0 / constants.critical_state_ratio)
    square_x, square_n = 2.0 * last.slope * d_slope * number_x, 2.0 * last.slope * d_slope * number_n

    factor, dry, beyond = flow_factor(at_rest(constants)), last.ratio - 2.0, last.ratio - 1.0
    flow_x = fused(last.plastic_compression, d_mean, last.mean)
    flow_x = fused(factor * last.relaxation, fused(square_x, dry, square * ratio_x), flow_x)
    flow_n = factor * fused(last.relaxation, fused(square_n, dry, square * ratio_n), square * dry)
    grown = 1.0 + last.relaxation
    yield_x = fused(-grown * grown, fused(square_x, beyond, square * ratio_x), d_q_squared)
    yield_n = -grown * fused(grown, fused(square_n, beyond, square * ratio_n), 2.0 * square * beyond)
    scale = -1.0 / fused(flow_x, yield_n, -flow_n * yield_x)
    x = fused(fused(last.of_flow, yield_n, -flow_n * last.of_yield), scale, last.plastic_compression)
    n = fused(fused(flow_x, last.of_yield, -last.of_flow * yield_x), scale, last.relaxation)
    return residuals_in_flow(x, n, trial, number, constants)


@pointwise
def is_root(last: FlowingIterate) -> bool:
    """Whether both equations hold, and s has not turned round."""
    of_yield = abs(last.of_yield) - TOLERANCE * last.ratio
    return max(of_yield, abs(last.of_flow) - STRAIN_TOLERANCE) <= 0.0 and last.relaxation >= 0.0


@pointwise
def is_short(state: FlowingIterate, constants: FlowingCamClay) -> bool:
    """Whether all power series hold."""
    of_strain = max(abs(state.growth), abs(state.plastic_compression) * total_slope(at_rest(constants)))
    of_number = state.inertial_number * growth_per_number(constants) * (1.0 / PARTS)
    return max(of_strain, of_number) <= LARGEST_EXPONENT


@pointwise
def growth_by_squaring(number: float, constants: FlowingCamClay) -> float:
    """p_c/p_c0, without a call of the exponential function, which takes one point at a time."""
    growth = exponential_series(min(number * growth_per_number(constants) * (1.0 / PARTS), LARGEST_EXPONENT))
    for _ in range(SQUARINGS):
        growth = growth * growth
    return growth


@pointwise
def number_factor(dt: float, constants: FlowingCamClay) -> float:
    """The factor b for a start at unit pressure."""
    stiffness = shear_modulus(inverse_swelling_index(at_rest(constants)), constants.poisson_ratio)
    per_strain = constants.grain_diameter * math.sqrt(constants.grain_density) / dt
    return constants.critical_state_ratio * per_strain / (2.0 * math.sqrt(3.0) * stiffness)


@pointwise
def at_rest(constants: FlowingCamClay) -> CamClay:
    """The constants of the surface at rest."""
    return CamClay(
        constants.critical_state_ratio,
        constants.compression_index,
        constants.swelling_index,
        constants.poisson_ratio,
    )
