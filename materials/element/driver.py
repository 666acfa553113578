"""The compiled driver: one point of a law led along a loading path, with the control solved inside the loop.

The driver works in the co-rotated frame: there is no spin, and the components of stress and strain refer to axes that
turn with the material. Strain is the time integral of D (logarithmic); density follows from it exactly,
rho_{n+1} = rho_n exp(-tr D dt), that is d(ln v) = tr D dt.
"""

import math
from collections.abc import Iterator
from functools import cache
from typing import Any

from numba import njit
from numba.extending import register_jitable

from grainlaw.materials.compilation import PointwiseLaw, explained, mark_of_reached, named, pointwise_law
from grainlaw.materials.element.path import LoadingPath
from grainlaw.materials.element.point import Point, is_finite, strain_reached
from grainlaw.materials.element.search import is_shut, narrowed, search_from
from grainlaw.materials.element.specimen import Specimen
from grainlaw.materials.errors import SimulationError
from grainlaw.materials.tensor import contraction, trace

# Relative to the target: 1e-7 Pa at 1000 Pa, still far above the round-off of a law that is stiff in the density.
CONTROL_TOLERANCE = 1e-10
# The same, where no strain rate gives less: a law that iterates to a tolerance of its own jumps by about as much.
LARGEST_JUMP = 1e-6
MAXIMUM_ITERATIONS = 200
# Share of the prescribed rate by which x first moves while its slope is unknown.
FIRST_REACH = 0.1

SEARCH_MARK = mark_of_reached([search_from, narrowed, is_shut, is_finite, Point])

register_jitable(search_from)
register_jitable(narrowed)
register_jitable(is_shut)
register_jitable(is_finite)


@cache
def make_advance(law: PointwiseLaw) -> Any:
    """The compiled loop over the steps of a path, for one law.

    advance(point, parameters, dt, rates, direction, free, held, target) -> (point, steps done); it stops
    before the first step whose control does not converge, or whose stress or density is not finite. Where the law jumps
    over the target, the control has converged if the jump is small.
    """
    update = law.update

    @njit(cache=True)
    @named(f"{law.mark}_{SEARCH_MARK}")
    def advance(point, parameters, dt, rates, direction, free, held, target):  # type: ignore[no-untyped-def]
        is_controlled = contraction(free, free) > 0.0
        tolerance, largest_jump = CONTROL_TOLERANCE * abs(target), LARGEST_JUMP * abs(target)
        for step in range(rates.size):
            prescribed = rates[step] * direction
            search = search_from(point.search.x, point.search.slope, FIRST_REACH * abs(rates[step]))
            allowed = tolerance
            for _ in range(MAXIMUM_ITERATIONS):
                strain_rate = prescribed + search.x * free
                density = point.density * math.exp(-trace(strain_rate) * dt)
                stress, state = update(point.stress, strain_rate, density, point.state, parameters, dt)
                residual = contraction(held, stress) - target
                if not is_controlled or abs(residual) <= tolerance:
                    break
                if is_shut(search, abs(rates[step])):
                    # The slope across a jump says nothing about the next step.
                    allowed, search = largest_jump, search_from(search.x, 0.0, 0.0)
                    break
                search = narrowed(search, residual)
            if is_controlled and not abs(residual) <= allowed:
                return point, step
            strain = point.strain + dt * strain_rate
            moved = Point(point.time, stress, strain, strain_rate, density, state, search)
            if not is_finite(moved):
                return point, step
            point = moved
        return point, rates.size

    return advance


def follow_path(specimen: Specimen, path: LoadingPath, point: Point, stride: int) -> Iterator[Point]:
    """The point after every `stride` steps of a path and after the last one.

    Raises SimulationError, with the time and the strain reached, if a held stress cannot be reached or stress or
    density are not finite.
    """
    advance = make_advance(pointwise_law(specimen.law))
    control = (path.direction, path.free, path.held, path.target)
    for start in range(0, path.steps, stride):
        rates = path.rates[start : start + stride]
        try:
            point, done = explained(specimen.law, advance, point, specimen.parameters, path.dt, rates, *control)
        except ArithmeticError as error:
            raise SimulationError(
                f"{specimen.law.name}: {error} after t = {point.time:g} s; {strain_reached(point)}"
            ) from error
        step = start + done
        point = point._replace(time=step * path.dt)
        if done < rates.size and not path.held_name:
            raise SimulationError(
                f"{specimen.law.name}: stress or density not finite in step {step + 1} "
                f"(t = {(step + 1) * path.dt:g} s); {strain_reached(point)}"
            )
        if done < rates.size:
            reached = contraction(path.held, point.stress)
            raise SimulationError(
                f"{specimen.law.name}: the {path.held_name} cannot be held in step {step + 1} "
                f"(t = {(step + 1) * path.dt:g} s); before it, the value is {reached:g} Pa of {path.target:g} Pa; "
                f"{strain_reached(point)}"
            )
        yield point
