"""Steady simple shear at held pressure: tau/p is mu(I), to round-off."""

import math

from grainlaw.materials.element.result import ElementResult
from grainlaw.materials.rheology import inertial_number
from grainlaw.materials.tensor import equivalent_shear_stress
from grainlaw.plugins.mu_i.friction import friction_of_inertial_number
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, scaled_error
from grainlaw.validation.cases.point.element import element_history

BAND = 1e-12
# Far beyond the elastic strain of 1e-3.
SHEAR_STRAIN, STEPS = 0.02, 5000
INERTIAL_NUMBERS = {Effort.QUICK: (0.001, 0.1), Effort.FULL: (1e-5, 1e-4, 0.001, 0.01, 0.1, 1.0, 10.0)}
CONSTANT_OF_THE_OTHER_RATE = {"inertial_number_constant": 0.279 * 2.0}


def history(number: float, assignments: dict[str, float]) -> ElementResult:
    """Shear at one inertial number until nothing changes any more."""
    rate = number / inertial_number(1.0, 1000.0, 0.005, 2450.0)
    duration = SHEAR_STRAIN / rate
    settings = {"slow_inertial_number": number, "fast_inertial_number": number, "time_step": duration / STEPS}
    durations = {"slow_duration": 0.0, "ramp_duration": 0.5 * duration, "fast_duration": 0.5 * duration}
    return element_history("constant-pressure-shear", "mu_i_lc", "paper", {**settings, **durations, **assignments})


def ratios(result: ElementResult) -> tuple[float, float]:
    """tau/p at the end, and mu(I) of the paper's constants at the present pressure and shear rate."""
    last, paper = result.points[-1], result.specimen.law.parameter_sets["paper"].parameters
    rate, pressure = float(result.shear_strain_rate[-1]), float(result.pressure[-1])
    number = inertial_number(rate, pressure, paper.grain_diameter, paper.grain_density)
    friction = friction_of_inertial_number(
        number, paper.static_friction, paper.dynamic_friction, paper.inertial_number_constant
    )
    return equivalent_shear_stress(last.stress) / pressure, friction


def measurements(effort: Effort, assignments: dict[str, float]) -> tuple[Measurement, ...]:
    """The stress ratio at each inertial number."""
    found = []
    for number in INERTIAL_NUMBERS[effort]:
        measured, reference = ratios(history(number, assignments))
        found.append(scaled_error(f"tau/p at I = {number:g}", "1", measured, reference, 1.0, BAND))
    return tuple(found)


def measure(effort: Effort) -> Evidence:
    """The law with the paper's constants."""
    found = measurements(effort, {})
    numbers = INERTIAL_NUMBERS[effort]
    figure = Figure(
        "Friction over inertial number",
        "log10 I",
        "tau/p",
        (
            curve("mu(I)", [math.log10(n) for n in numbers], [m.reference for m in found], "reference"),
            curve("mu_i_lc", [math.log10(n) for n in numbers], [m.measured for m in found]),
        ),
    )
    return Evidence(found, figures=(figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The engineering shear rate's constant, taken over without halving it."""
    return measurements(effort, CONSTANT_OF_THE_OTHER_RATE)


CASE = Case(
    name="simple_shear",
    title="simple shear at 1 kPa, mu(I)-LC",
    proves="the flow rule and the shear rate's invariant agree: no factor 2 or sqrt(3) in the friction",
    reference="tau/p = mu(I) = mu_0 + (mu_d - mu_0)/(I_0/I + 1) (paper Eq. 2, constants of Table 1)",
    norm="|tau/p - mu(I)|",
    mistake="I_0 twice as large, as if it were counted in the engineering shear rate",
    measure=measure,
    control=control,
)
