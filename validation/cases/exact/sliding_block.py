"""A stiff block slides down a plane: the Coulomb floor takes mu N from it, no more and no less."""

import math
from typing import Any

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.scenes import advance, shipped_simulation

BAND = 5e-3
ANGLE, FRICTION, GRAVITY = math.radians(30.0), 0.3, 9.81
END = 0.5
STIFFER = {"material.linear_elastic.bulk_modulus": 1e7}


def exact_distance(time: float) -> float:
    """Of a rigid block from rest [m]."""
    return 0.5 * GRAVITY * (math.sin(ANGLE) - FRICTION * math.cos(ANGLE)) * time**2


def path(changes: dict[str, Any], friction_mobilised: bool = True) -> list[tuple[float, float]]:
    """Times [s] and distances of the centre of mass [m].

    An elastic block that starts without shear stress sticks to the floor until a shear wave has mobilised the friction,
    after about tan(phi)/tan(theta) H/c_s, and keeps the velocity of mu g cos(theta) times half of that. The exact
    solution is that of a block whose friction acts from the start, so the block starts with the shear stress of steady
    sliding, sigma_xy = mu p in each layer.
    """
    simulation = shipped_simulation("sliding_block", changes)
    body = simulation.bodies[0]
    if friction_mobilised:
        body.stress[3] = -FRICTION * body.stress[1]
    start = float(body.positions[0].mean())
    found = [(0.0, 0.0)]

    def observe(present: Simulation) -> None:
        found.append((present.time, float(body.positions[0].mean()) - start))

    advance(simulation, END, observe, intervals=20)
    return found


def distance(label: str, found: list[tuple[float, float]]) -> Measurement:
    """The distance at the end."""
    return relative_error(f"distance after {END:g} s{label}", "m", found[-1][1], exact_distance(END), BAND)


def measure(effort: Effort) -> Evidence:
    """The shipped scene with friction mobilised; in full also a stiffer block and a finer grid."""
    shipped = path({})
    times = [time for time, _ in shipped]
    figure = Figure(
        "Sliding block",
        "time [s]",
        "distance [m]",
        (
            curve("exact", times, [exact_distance(time) for time in times], "reference"),
            curve("measured", times, [x for _, x in shipped]),
        ),
    )
    found = [distance("", shipped)]
    if effort is Effort.FULL:
        found.append(distance(", stiffer block", path(STIFFER)))
        found.append(distance(", half the cell", path({"grid.cell_size": 0.0125})))
    late = relative_error("", "m", path({}, friction_mobilised=False)[-1][1], exact_distance(END), BAND)
    note = f"a block that starts without shear stress is {late.error:.2%} ahead: it slides before its friction acts"
    return Evidence(tuple(found), figures=(figure,), notes=(note,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A floor whose friction is 3 % too large."""
    return (distance("", path({"boundary.bottom.coefficient": 1.03 * FRICTION})),)


CASE = Case(
    name="sliding_block",
    title="block sliding down a plane of 30 degrees",
    proves="the friction wall takes Coulomb's share of the normal impulse while the block rings on it",
    reference="x = g (sin theta - mu cos theta) t^2/2",
    norm="relative error of the distance of the centre of mass",
    mistake="friction coefficient of the floor 3 % too large",
    measure=measure,
    control=control,
)
