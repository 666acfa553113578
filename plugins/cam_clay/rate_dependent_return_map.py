"""The return map of Cam Clay whose yield surface depends on the plastic inertial number I of the step itself.

I is that of the plastic shear of the step, with p at its end. For an assumed I the step is one of Cam Clay with M(I)
and p_c(I) (`cam_clay_step`, exact and bracketed), and gives back a plastic shear, so an inertial number. A larger
assumed I makes a larger surface, so less plastic shear: what is found falls while what is assumed rises. The one root
is found by the secant method from the I of the step before, with bisection wherever that leaves its bracket. The return
of Cam Clay leaves a trace of F, which a fast step would magnify in I; its end lies exactly on the surface of a slightly
different I, and that one counts as assumed. An elastic step gives the largest I at which there is flow. A step of some
per cent can soften so much that its return jumps over that root; it is then taken in equal substeps. Where the root is
not found in the finest of them either, the result is NaN.

Source: this project's.
"""

import math
from typing import NamedTuple

from grainlaw.materials import (
    SymmetricTensor,
    contraction,
    half_norm,
    inertial_number,
    pointwise,
    shear_modulus,
)
from grainlaw.plugins.cam_clay.rate_dependent import (
    FlowingCamClay,
    growth_of_surface,
    growth_per_number,
    plastic_index_of,
    sensitive_inertial_number,
    slope_of_stress_ratio,
    steady_stress_ratio,
)
from grainlaw.plugins.cam_clay.return_map import CamClay, CamClayStep, cam_clay_step

# Of the yield surface by the inertial number found against the one assumed.
TOLERANCE = 1e-9
MAXIMUM_ITERATIONS = 60
ROUND_OFF = 1e-15
# The same; more means that the return jumps.
LARGEST_MISMATCH = 1e-6
# Strain below which a return does not jump.
SMALLEST_PART = 1e-4
# Of steps beyond any range, which would take for ever and lead nowhere.
LARGEST_PARTS = 4**7


class FlowingStep(NamedTuple):
    """The end of a step.

    mean_pressure, deviator     p and s [Pa]
    size_at_rest                p_c0 [Pa]
    inertial_number             of its plastic strain
    surface_inertial_number     of the yield surface on which it ends: the same, to the tolerance
    """

    mean_pressure: float
    deviator: SymmetricTensor
    size_at_rest: float
    inertial_number: float
    surface_inertial_number: float


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


@pointwise
def flowing_cam_clay_step(
    start_pressure: float,
    start_deviator: SymmetricTensor,
    compression: float,
    shear: SymmetricTensor,
    size_at_rest: float,
    expected_inertial_number: float,
    dt: float,
    constants: FlowingCamClay,
) -> FlowingStep:
    """One strain increment in contact (volumetric, compression-positive, and deviatoric) over `dt` [s].

    `expected_inertial_number` is the one to try first, that of the step before. The result is NaN if the return of Cam
    Clay does not converge, or if no inertial number is found.
    """
    increment = Increment(start_pressure, start_deviator, compression, shear, size_at_rest, dt)
    flow = substepped_where_it_jumps(increment, expected_inertial_number, constants)
    return FlowingStep(flow.end.mean_pressure, flow.end.deviator, flow.size_at_rest, flow.found, flow.assumed)


@pointwise
def substepped_where_it_jumps(increment: Increment, guess: float, constants: FlowingCamClay) -> Flow:
    """The whole step or, where its return jumps, the last of as many equal parts as it takes not to; NaN if none do."""
    size = abs(increment.compression) + half_norm(increment.shear)
    largest_parts = min(size / SMALLEST_PART, LARGEST_PARTS)
    parts = 1
    while True:
        flow, is_consistent = substepped(increment, parts, guess, constants)
        if is_consistent:
            return flow
        if not parts < largest_parts:
            return unfound(flow)
        parts *= 4


@pointwise
def unfound(flow: Flow) -> Flow:
    """A step without an inertial number of its own."""
    nothing = CamClayStep(math.nan, math.nan, flow.end.deviator, math.nan, math.nan)
    return Flow(nothing, math.nan, math.nan, math.nan, math.nan, math.nan)


@pointwise
def substepped(increment: Increment, parts: int, guess: float, constants: FlowingCamClay) -> tuple[Flow, bool]:
    """The last of equal parts of a step, and True; or the first that has not the inertial number of its strain."""
    start = CamClayStep(increment.start_pressure, increment.size_at_rest, increment.start_deviator, 0.0, 0.0)
    flow = Flow(start, increment.size_at_rest, 0.0, guess, 0.0, 0.0)
    largest_mismatch = LARGEST_MISMATCH * sensitive_inertial_number(constants)
    compression, shear, dt = increment.compression / parts, increment.shear * (1.0 / parts), increment.dt / parts
    for _ in range(parts):
        part = Increment(flow.end.mean_pressure, flow.end.deviator, compression, shear, flow.size_at_rest, dt)
        flow = consistent_flow(part, flow.found, constants)
        if not abs(flow.found - flow.assumed) <= largest_mismatch:
            return flow, False
    return flow, True


@pointwise
def consistent_flow(increment: Increment, guess: float, constants: FlowingCamClay) -> Flow:
    """The step whose plastic strain has the inertial number of its yield surface."""
    tolerance = TOLERANCE * sensitive_inertial_number(constants)
    flow = flow_at(guess, increment, constants, 0.0)
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
                flow = onset_of_flow(flow.end, lower, increment, constants)
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
        new = flow_at(trial, increment, constants, expected)
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
def onset_of_flow(elastic: CamClayStep, lower: float, increment: Increment, constants: FlowingCamClay) -> Flow:
    """An elastic step with the inertial number whose yield surface it just reaches, at which flow sets in.

    F = 0 is solved in the logarithm of p_c0, which is convex in I, by Newton's method from below; `lower` is an
    inertial number at which the step is plastic, or 0.
    """
    p, s = elastic.mean_pressure, elastic.deviator
    q_squared = 1.5 * contraction(s, s)
    per_number = growth_per_number(constants)
    number = lower
    for _ in range(MAXIMUM_ITERATIONS):
        m = steady_stress_ratio(number, constants)
        reduced = q_squared / (m * m)
        excess = math.log((reduced / p + p) / increment.size_at_rest) - number * per_number
        if excess <= ROUND_OFF:
            break
        number += excess / (
            2.0 * reduced / (reduced + p * p) * slope_of_stress_ratio(number, constants) / m + per_number
        )
    if number == 0.0:
        return Flow(elastic_end(elastic, increment.size_at_rest), increment.size_at_rest, 0.0, 0.0, 0.0, 0.0)
    size = increment.size_at_rest * growth_of_surface(number, constants)
    return on_surface(elastic_end(elastic, size), size, number, increment, constants)


@pointwise
def elastic_end(step: CamClayStep, size: float) -> CamClayStep:
    """An elastic step with a yield surface of another size p_c."""
    return CamClayStep(step.mean_pressure, size, step.deviator, 0.0, 0.0)


@pointwise
def flow_at(assumed: float, increment: Increment, constants: FlowingCamClay, expected: float) -> Flow:
    """The Cam Clay step with the surface of an inertial number; `expected` as in `cam_clay_step`."""
    size = increment.size_at_rest * growth_of_surface(assumed, constants)
    end = cam_clay_step(
        increment.start_pressure,
        increment.start_deviator,
        increment.compression,
        increment.shear,
        size,
        CamClay(
            steady_stress_ratio(assumed, constants),
            constants.compression_index,
            constants.swelling_index,
            constants.poisson_ratio,
        ),
        expected,
    )
    if end.plastic_shear == 0.0 and end.plastic_compression == 0.0:
        return Flow(end, increment.size_at_rest, assumed, 0.0, 0.0, 0.0)
    return on_surface(end, size, assumed, increment, constants)


@pointwise
def on_surface(end: CamClayStep, size: float, assumed: float, increment: Increment, constants: FlowingCamClay) -> Flow:
    """A step that ends on the yield surface, to the tolerance of its return; `size` is its p_c [Pa] at the start.

    Moving the surface by dF changes the multiplier by dF/(K F_p^2 + 3 G F_q^2 + H), H from hardening.
    """
    p, p_c, s = end.mean_pressure, end.preconsolidation_pressure, end.deviator
    m = steady_stress_ratio(assumed, constants)
    plastic_index = plastic_index_of(constants)
    reduced = 1.5 * contraction(s, s) / (m * m)

    f = reduced - p * (p_c - p)
    f_p, f_q = 2.0 * p - p_c, 2.0 * math.sqrt(reduced) / m
    f_i = -2.0 * reduced / m * slope_of_stress_ratio(assumed, constants)
    f_i -= p * p_c / (constants.dilation_inertial_number * plastic_index)
    bulk_modulus = p / constants.swelling_index
    stiffness = bulk_modulus * f_p * f_p + p * p_c * f_p / plastic_index
    stiffness += 3.0 * shear_modulus(bulk_modulus, constants.poisson_ratio) * f_q * f_q
    # Dry of the critical state softening can outweigh the rest.
    per_number = f_i / stiffness if stiffness > 0.0 else 0.0

    number_of_strain = inertial_number(1.0 / increment.dt, p, constants.grain_diameter, constants.grain_density)
    return Flow(
        end,
        increment.size_at_rest * (p_c / size),
        assumed - f / f_i,
        end.plastic_shear * number_of_strain,
        0.5 * math.sqrt(3.0) * f_q * per_number * number_of_strain,
        f_p * per_number,
    )
