"""Jumps of the shear rate: the unified law overshoots, dilates and comes back to the right steady state."""

import numpy as np

from grainlaw.materials.element.result import ElementResult
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, scaled_error, upper_bound
from grainlaw.validation.cases.point.element import element_history

BAND, TRANSIENT_BAND = 1e-6, 0.5
SLOW, FAST = 0.01, 0.1
# The jump takes a step; half of the strain before it, half after.
DURATIONS = {"slow_duration": 2.0, "ramp_duration": 1e-4, "fast_duration": 2.0, "time_step": 1e-4}
WITHOUT_DILATION = {"dilation_inertial_number": 1e15}


def jump(first: float, second: float, changes: dict[str, float] | None = None) -> ElementResult:
    """Shear at held pressure with a jump of the inertial number after 2 s."""
    settings = {"slow_inertial_number": first, "fast_inertial_number": second, **DURATIONS}
    return element_history("constant-pressure-shear", "mu_i_mcc", "paper", settings | (changes or {}))


def steady_ratio(number: float, result: ElementResult) -> float:
    """M(I)."""
    paper = result.specimen.parameters
    slow = paper.critical_state_ratio
    return slow + (paper.dynamic_state_ratio - slow) * number / (paper.friction_inertial_number + number)


def measurements(result: ElementResult, second: float, name: str) -> tuple[Measurement, ...]:
    """The steady state after the jump, and how far q/p strays from the steady values on its way."""
    ratio = result.deviatoric_stress / result.pressure
    after = result.time > DURATIONS["slow_duration"] + 2.0 * DURATIONS["time_step"]
    end = steady_ratio(second, result)
    stray = float((ratio[after] - end).max() if second == FAST else (end - ratio[after]).max())
    # The band asks for a transient of more than 0.02, a sixtieth of M.
    return (
        scaled_error(f"{name}: q/p at the end", "1", float(ratio[-1]), end, 1.0, BAND),
        upper_bound(f"{name}: 0.01 over the overshoot of q/p", "1", 0.01 / max(stray, 1e-12), TRANSIENT_BAND),
    )


def measure(effort: Effort) -> Evidence:
    """A jump up and a jump down."""
    up, down = jump(SLOW, FAST), jump(FAST, SLOW)
    curves = [curve(name, r.time, r.deviatoric_stress / r.pressure) for name, r in (("up", up), ("down", down))]
    volumes = [curve(name, r.time, r.log_specific_volume) for name, r in (("up", up), ("down", down))]
    figures = (
        Figure("q/p over a jump of I between 0.01 and 0.1", "time [s]", "q/p", tuple(curves)),
        Figure("ln v over the same jumps", "time [s]", "ln v", tuple(volumes)),
    )
    change = float(np.ptp([up.log_specific_volume[-1], down.log_specific_volume[-1]]))
    expected = (FAST - SLOW) / up.specimen.parameters.dilation_inertial_number
    volume = scaled_error("ln v, fast less slow", "1", change, expected, 1.0, BAND)
    return Evidence((*measurements(up, FAST, "up"), *measurements(down, SLOW, "down"), volume), figures=figures)


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Friction that follows I, volume that does not."""
    return measurements(jump(SLOW, FAST, WITHOUT_DILATION), FAST, "up")


CASE = Case(
    name="mu_i_mcc_rate_jump",
    title="jumps of the shear rate, mu(I)-MCC",
    proves="the transient between steady states: overshoot with dilation upwards, undershoot with compaction downwards",
    reference="M(I) and v(I, p) after the jump; I_v -> infinity has no transient, q/p goes to M(I) from one side",
    norm="absolute errors of q/p and ln v; 0.01 over the overshoot",
    mistake="I_v infinite: no dilation, hence no overshoot",
    measure=measure,
    control=control,
)
