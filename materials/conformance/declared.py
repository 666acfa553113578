"""Checks of what a law declares: completeness, units against equations, bounds against behaviour."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from grainlaw.materials import Parameter, SymmetricTensor, isotropic, pressure, trace
from grainlaw.materials.conformance.outcome import Outcome
from grainlaw.materials.conformance.subject import DT, PointState, Subject, largest_difference, random_strain_rates
from grainlaw.materials.law import check_law

TOLERANCE = 1e-8
# Other units of length, mass and time: powers of four, so that no rounding hides behind the change.
LENGTH, MASS, TIME = 4.0, 16.0, 0.25
BASE = {"m": LENGTH, "kg": MASS, "s": TIME, "1": 1.0, "rad": 1.0, "K": 1.0}
BASE["N"] = MASS * LENGTH / TIME**2
BASE["Pa"] = BASE["N"] / LENGTH**2
BASE["J"] = BASE["N"] * LENGTH
_FACTOR = re.compile(r"([./]?)([A-Za-z]+|1)(\d*)")
SMALLEST_HEADER = 5
LOWER_END, UPPER_END = 0.02, 0.98
# Compression [1/s] with a little shear, which must not take the pressure away; much of it may, as in soft clay.
LOADING = SymmetricTensor(-0.016, -0.018, -0.016, 0.0, 0.0, 0.0)
LOADING_STEPS = 20


def declarations(subject: Subject) -> Outcome:
    """Everything is declared, and the header says more than a title."""
    law = subject.law
    check_law(law)
    if len(law.documentation.splitlines()) < SMALLEST_HEADER:
        return Outcome("FAIL", f"the header of {law.source_file.name} is shorter than {SMALLEST_HEADER} lines")
    for name, parameter_set in law.parameter_sets.items():
        if not parameter_set.source.strip():
            return Outcome("FAIL", f"parameter set '{name}' names no source")
    count = f"{len(law.parameter_declarations)} parameters, {len(law.state_declarations)} state variables"
    return Outcome("pass", f"{count}, {len(law.parameter_sets)} parameter sets")


def factor(unit: str) -> float:
    """By how much the number in front of a unit grows in the other units."""
    value = 1.0
    for sign, name, power in _FACTOR.findall(unit):
        one = BASE[name] ** int(power or 1)
        value = value / one if sign == "/" else value * one
    return value


def units(subject: Subject) -> Outcome:
    """In other units of length, mass and time the law gives the same answers: its equations agree with its units."""
    law = subject.law
    of_parameters = [factor(found.unit) for found in law.parameter_declarations.values()]
    of_state = [factor(found.unit) for found in law.state_declarations.values()]
    parameters = law.parameters(*(value * k for value, k in zip(subject.parameters, of_parameters, strict=True)))

    def converted(point: PointState) -> PointState:
        state = law.state(*(value * k for value, k in zip(point.state, of_state, strict=True)))
        return PointState(BASE["Pa"] * point.stress, point.density * factor("kg/m3"), state)

    worst, what = 0.0, ""
    start = subject.at_rest(subject.pressure)
    other_start = converted(start)
    made = law.initial_state(other_start.stress, other_start.density, parameters)
    differences = [("initial_state", made, other_start.state, 0.0)]
    for call in subject.calls:
        begin, end = converted(call.start), converted(call.end)
        rate = factor("1/s") * call.strain_rate
        stress, state = law.update(begin.stress, rate, end.density, begin.state, parameters, call.dt * TIME)
        speed = law.sound_speed(*end, parameters)
        expected = law.sound_speed(*call.end, subject.parameters) * factor("m/s")
        differences += [
            ("the stress of update", stress, end.stress, subject.pressure * BASE["Pa"]),
            ("the state of update", state, end.state, 0.0),
            ("sound_speed", (speed,), (expected,), 0.0),
        ]
        if law.stored_energy is not None:
            energy = law.stored_energy(*end, parameters)
            expected = law.stored_energy(*call.end, subject.parameters) * factor("J/kg")
            differences.append(("stored_energy", (energy,), (expected,), 0.0))
    for name, one, other, scale in differences:
        difference = largest_difference(tuple(one), tuple(other), scale)
        if not difference <= worst:
            worst, what = difference, name
    if not worst <= TOLERANCE:
        return Outcome("FAIL", f"in other units {what} differs by {worst:.1e}: a unit or an equation is wrong")
    return Outcome("pass", f"the same in other units to {worst:.0e}")


def bounds(subject: Subject) -> Outcome:
    """Parameters anywhere within their bounds are refused as inconsistent, or give finite answers and carry load."""
    law = subject.law
    draws, refused = list(_draws(subject)), 0
    for values in draws:
        parameters = law.parameters(**values)
        if law.inconsistency(parameters):
            refused += 1
            continue
        fault = _fault_of(subject, parameters)
        if fault:
            return Outcome("FAIL", f"{fault} at {listed(values)}")
    return Outcome("pass", f"{len(draws)} draws, {refused} refused as inconsistent, the others finite and under load")


def listed(values: Mapping[str, float]) -> str:
    """Parameters by name, for a reason."""
    return ", ".join(f"{name} = {value:.3g}" for name, value in values.items())


def _draws(subject: Subject) -> Iterator[dict[str, float]]:
    """Parameters at the ends of their bounds, then all of them anywhere within."""
    random = np.random.default_rng(0)
    yield from at_ends_of_bounds(subject, random, 10 * subject.effort)
    for _ in range(10 * subject.effort):
        yield {
            name: _between(found, getattr(subject.parameters, name), random.uniform(LOWER_END, UPPER_END))
            for name, found in subject.law.parameter_declarations.items()
        }


def at_ends_of_bounds(subject: Subject, random: np.random.Generator, corners: int) -> Iterator[dict[str, float]]:
    """Each parameter at either end of its bounds, the others as they are; then `corners` times all at some end."""
    declared, values = subject.law.parameter_declarations, subject.parameters._asdict()
    for share in (LOWER_END, UPPER_END):
        for name, found in declared.items():
            yield {**values, name: _between(found, values[name], share)}
    for _ in range(corners):
        yield {
            name: _between(found, values[name], random.choice((LOWER_END, UPPER_END)))
            for name, found in declared.items()
        }


def _between(declaration: Parameter, value: float, share: float) -> float:
    """A value at a share of the way between finite bounds, else from a third of the value to three times it.

    At the ends of the way, it is the bound itself where that belongs to the allowed values.
    """
    interval = declaration.interval
    if share == LOWER_END and not interval.lower_open:
        return interval.lower
    if share == UPPER_END and not interval.upper_open:
        return interval.upper
    if math.isfinite(interval.lower) and math.isfinite(interval.upper):
        return interval.lower + share * (interval.upper - interval.lower)
    return min(max(value * 10.0 ** (share - 0.5), interval.lower), interval.upper)


def _fault_of(subject: Subject, parameters: Any) -> str:
    """What is wrong with the law's answers along a random path or under load; empty if nothing is."""
    law = subject.law
    try:
        if _last_pressure(subject, parameters, random_strain_rates(60, 1)) is None:
            return "not finite"
        loaded = _last_pressure(subject, parameters, [LOADING] * LOADING_STEPS)
        if loaded is None:
            return "not finite"
        if not (law.carries_tension or loaded > subject.pressure):
            compression = -LOADING_STEPS * DT * trace(LOADING)
            return f"compression by {compression:.0%} takes the pressure from {subject.pressure:.4g} to {loaded:.4g} Pa"
    except ArithmeticError as error:
        return f"{type(error).__name__}: {error}"
    except ValueError as error:
        return f"ValueError: {error}"
    return ""


def _last_pressure(subject: Subject, parameters: Any, rates: Iterable[SymmetricTensor]) -> float | None:
    """The pressure [Pa] at the end of a path from rest; None where a number on the way is not finite."""
    law = subject.law
    density = subject.parameter_set.density(subject.pressure, parameters)
    stress = isotropic(-subject.pressure)
    state = law.initial_state(stress, density, parameters)
    for rate in rates:
        density *= math.exp(-trace(rate) * DT)
        stress, state = law.update(stress, rate, density, state, parameters, DT)
        numbers = (*stress, *state, law.sound_speed(stress, density, state, parameters))
        if not all(math.isfinite(number) for number in numbers):
            return None
    return pressure(stress)
