"""Steady shear of the unified law at held pressure: friction M(I) and specific volume v(I, p)."""

import math

from grainlaw.materials.element.result import ElementResult
from grainlaw.materials.rheology import inertial_number
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, scaled_error
from grainlaw.validation.cases.point.element import element_history

BAND = 1e-6
NUMBERS = {Effort.QUICK: (1e-5, 1e-2, 1.0), Effort.FULL: (1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 1.0)}
PRESSURE = 1000.0
# Enough for the transient to fall below 1e-8.
SHEAR_STRAIN, STEPS = 4.0, 40_000


def history(number: float) -> ElementResult:
    """Shear at one inertial number, from the normally consolidated state at rest."""
    duration = SHEAR_STRAIN / (number / inertial_number(1.0, PRESSURE, 0.005, 2450.0))
    settings = {"slow_inertial_number": number, "fast_inertial_number": number, "time_step": duration / STEPS}
    durations = {"slow_duration": 0.0, "ramp_duration": 0.5 * duration, "fast_duration": 0.5 * duration}
    return element_history("constant-pressure-shear", "mu_i_mcc", "paper", {**settings, **durations})


def errors(number: float, result: ElementResult, friction_number: float | None = None) -> tuple[Measurement, ...]:
    """q/p and ln v at the end against the law's two steady-state formulas."""
    paper = result.specimen.parameters
    constant = friction_number or paper.friction_inertial_number
    slow, fast = paper.critical_state_ratio, paper.dynamic_state_ratio
    ratio = slow + (fast - slow) * number / (constant + number)
    # Half of p_c = p lies at the critical state line; ln v there from the initial state by (3) of the law.
    line = float(result.log_specific_volume[0])
    line -= (paper.compression_index - paper.swelling_index) * math.log(2.0)
    volume = line + number / paper.dilation_inertial_number
    measured = float(result.deviatoric_stress[-1] / result.pressure[-1])
    return (
        scaled_error(f"q/p at I = {number:g}", "1", measured, ratio, 1.0, BAND),
        scaled_error(f"ln v at I = {number:g}", "1", float(result.log_specific_volume[-1]), volume, 1.0, BAND),
    )


def measure(effort: Effort) -> Evidence:
    """The law as it is."""
    found = [errors(number, history(number)) for number in NUMBERS[effort]]
    logs = [math.log10(number) for number in NUMBERS[effort]]
    figures = tuple(
        Figure(
            title,
            "log10 I",
            title,
            (
                curve("formula", logs, [pair[k].reference for pair in found], "reference"),
                curve("mu_i_mcc", logs, [pair[k].measured for pair in found]),
            ),
        )
        for k, title in enumerate(("q/p", "ln v"))
    )
    return Evidence(tuple(one for pair in found for one in pair), figures=figures)


def control(effort: Effort) -> tuple[Measurement, ...]:
    """I_M of the engineering shear rate."""
    return errors(1e-2, history(1e-2), 2.0 * 0.279)


CASE = Case(
    name="mu_i_mcc_steady_shear",
    title="steady shear of mu(I)-MCC",
    proves="the unified law contains its fluid-like parent: mu(I), and a steady volume that follows I and p",
    reference="q/p = M_csl + (M_inf - M_csl) I/(I_M + I); ln v = ln v_csl(p) + I/I_v",
    norm="absolute error of q/p and ln v",
    mistake="I_M twice as large, as if it were counted in the engineering shear rate",
    measure=measure,
    control=control,
)
