"""Checks of a law as a program: finite everywhere, pure, the same compiled, for a GPU too, and its cost."""

import math
import time
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from types import SimpleNamespace
from typing import Any
from unittest import mock

import numpy as np
from numba import njit, typeof, types

from grainlaw.materials import SymmetricTensor, isotropic
from grainlaw.materials.compilation import PointwiseLaw, explained, make_single_step, named, pointwise_law
from grainlaw.materials.conformance.outcome import Outcome, judged
from grainlaw.materials.conformance.subject import DT, PointState, Subject, flowing_strain_rates
from grainlaw.materials.precision import as_numbers

COMPUTE_CAPABILITY = (7, 5)
TIMED_UPDATES, TIMED_STEPS = 200_000, 2000
# Between singles and doubles, over the stress.
LARGEST_DIFFERENCE = 1e-3
DIRECTIONS = {
    "no strain": isotropic(0.0),
    "compression": isotropic(-1.0 / 3.0),
    "extension": isotropic(1.0 / 3.0),
    "shear": SymmetricTensor(0.0, 0.0, 0.0, 1.0, 0.0, 0.0),
}


def finite(subject: Subject) -> Outcome:
    """Stress, state and speed of sound are numbers at p = 0, while a point is open, and while it closes."""
    starts = {"at p = 0": subject.at_rest(0.0), "opened by 50 %": _strained(subject, "extension", 0.5)}
    starts["opened and closed"] = _strained(subject, "compression", 0.6, starts["opened by 50 %"])
    for where, start in starts.items():
        if not _is_finite(subject, start):
            return Outcome("FAIL", f"not finite {where}")
        for name, direction in DIRECTIONS.items():
            for size in (1e-9, 1e-4, 1e-2):
                try:
                    end = subject.moved(start, size / DT * direction)
                except ArithmeticError as error:
                    return Outcome("FAIL", f"{type(error).__name__} {where}, {name} of {size:g}: {error}")
                if not _is_finite(subject, end):
                    return Outcome("FAIL", f"not finite {where}, {name} of {size:g}")
    return Outcome("pass", "at p = 0, opened and closed again")


def pure(subject: Subject) -> Outcome:
    """The same input gives the same output, however often and in whatever order."""
    law, parameters = subject.law, subject.parameters
    order = np.random.default_rng(0).permutation(len(subject.calls)).tolist()
    for sequence in (order, order[::-1]):
        for index in sequence:
            start, strain_rate, dt, end = subject.calls[index]
            again = law.update(start.stress, strain_rate, end.density, start.state, parameters, dt)
            if again != (end.stress, end.state):
                return Outcome("FAIL", "update gives another result for the same input: it keeps something of its own")
    points = [call.end for call in subject.calls]
    first = [law.sound_speed(end.stress, end.density, end.state, parameters) for end in points]
    second = [law.sound_speed(end.stress, end.density, end.state, parameters) for end in reversed(points)]
    if first != second[::-1]:
        return Outcome("FAIL", "sound_speed gives another result for the same input: it keeps something of its own")
    return Outcome("pass", f"{len(subject.calls)} updates repeated in other orders")


def compiled(subject: Subject) -> Outcome:
    """Compiled code gives the bits of plain Python."""
    step = make_single_step(pointwise_law(subject.law))
    for number, call in enumerate(subject.calls):
        start = call.start
        arguments = (start.stress, call.strain_rate, call.end.density, start.state, subject.parameters, call.dt)
        found = explained(subject.law, step, *arguments)
        if found != (call.end.stress, call.end.state):
            return Outcome("FAIL", f"compiled code and plain Python differ in update {number}")
    return Outcome("pass", f"{len(subject.calls)} updates, bit for bit")


def single(subject: Subject) -> Outcome:
    """A law that says so holds in single precision."""
    if not subject.law.holds_in_single:
        return Outcome("skipped", "not stated: the law is computed in double precision")
    step, worst = make_single_step(pointwise_law(subject.law, "single")), 0.0
    for start, strain_rate, dt, end in subject.calls:
        point = start.stress, strain_rate, end.density, start.state, subject.parameters, dt
        found, _ = explained(subject.law, step, *(as_numbers(value, np.float32) for value in point))
        scale = max(subject.pressure, *map(abs, end.stress))
        worst = max(worst, *(abs(a - b) / scale for a, b in zip(found, end.stress, strict=True)))
    return judged(worst < LARGEST_DIFFERENCE, f"{worst:.1e} of the stress, allowed: {LARGEST_DIFFERENCE:g}")


def ptx(subject: Subject) -> Outcome:
    """The law compiles for a GPU; none need be present."""
    try:
        version("numba-cuda")
    except PackageNotFoundError:
        return Outcome("skipped", "numba-cuda is not installed")
    from numba.cuda import compile_ptx  # type: ignore[attr-defined]

    device = SimpleNamespace(compute_capability=COMPUTE_CAPABILITY)
    start = subject.at_rest(subject.pressure)
    tensor = typeof(start.stress)
    arguments = (tensor, tensor, types.float64, typeof(start.state), typeof(subject.parameters), types.float64)
    pointwise_law(subject.law)
    with mock.patch("numba.cuda.dispatcher.get_current_device", return_value=device):
        try:
            compile_ptx(lambda x: 2.0 * x, (types.float64,), device=True, cc=COMPUTE_CAPABILITY)
        except Exception as error:
            return Outcome("skipped", f"numba-cuda finds no CUDA toolkit ({type(error).__name__})")
        text, _ = compile_ptx(subject.law.update, arguments, device=True, cc=COMPUTE_CAPABILITY)
    return judged(".target sm_75" in text, f"{len(text.splitlines())} lines of PTX")


def cost(subject: Subject) -> Outcome:
    """Nanoseconds of one compiled update after another; a report, not a limit."""
    return Outcome(
        "pass", f"{nanoseconds_per_update(subject):.0f} ns per update in shear flow, one point after the other"
    )


def nanoseconds_per_update(subject: Subject) -> float:
    """Processor time of one compiled update [ns] in shear flow."""
    repeat = _make_repeat(pointwise_law(subject.law))
    start = subject.at_rest(subject.pressure)
    rates = flowing_strain_rates(TIMED_STEPS)
    arguments = (start.stress, start.density, start.state, subject.parameters, rates, DT)
    explained(subject.law, repeat, *arguments, 1)
    begin = time.process_time()
    repeat(*arguments, TIMED_UPDATES // len(rates))
    return (time.process_time() - begin) / TIMED_UPDATES * 1e9


@cache
def _make_repeat(law: PointwiseLaw) -> Any:
    """A compiled loop that leads one point along a path again and again; it returns a stress, lest it be left out."""
    update = law.update

    @njit(cache=True)
    @named(law.mark)
    def repeat(stress, density, state, parameters, rates, dt, times):  # type: ignore[no-untyped-def]
        total = 0.0
        for _ in range(times):
            s, rho, memory = stress, density, state
            for k in range(rates.shape[0]):
                d = SymmetricTensor(rates[k, 0], rates[k, 1], rates[k, 2], rates[k, 3], rates[k, 4], rates[k, 5])
                rho *= math.exp(-(d.xx + d.yy + d.zz) * dt)
                s, memory = update(s, d, rho, memory, parameters, dt)
            total += s.xx
        return total

    return repeat


def _strained(subject: Subject, direction: str, strain: float, start: PointState | None = None) -> PointState:
    point = start or subject.at_rest(subject.pressure)
    for _ in range(100):
        point = subject.moved(point, 0.01 * strain / DT * DIRECTIONS[direction])
    return point


def _is_finite(subject: Subject, point: PointState) -> bool:
    speed = subject.law.sound_speed(*point, subject.parameters)
    return speed >= 0.0 and all(math.isfinite(value) for value in (*point.stress, *point.state, speed))
