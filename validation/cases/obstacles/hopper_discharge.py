"""A flat silo empties through a slot at a rate that does not know how high it is filled, and grows as W^(3/2)."""

import math
from typing import Any

import numpy as np

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, scaled_error
from grainlaw.validation.scenes import advance, shipped_simulation

BAND = 0.05
GRAVITY, DENSITY = 9.81, 1500.0
OPENINGS, CELLS_ACROSS = (0.1, 0.15, 0.2), 12
HEAD, LOWER_HEAD = 0.9, 0.6
FROM, UNTIL = 0.4, 0.8  # when the flow is steady, and the silo not yet empty [s]


def silo(opening: float, head: float, cell: float) -> dict[str, Any]:
    """Changes of the shipped scene: the width of the slot, the height of the filling and the cell [m]."""
    left, right = 0.3 - 0.5 * opening, 0.3 + 0.5 * opening
    return {
        "grid.cell_size": cell,
        "body.0.shape.upper": [0.6, head],
        "obstacle.0.shape.upper": [left, 0.0],
        "obstacle.1.shape.lower": [right, -0.05],
        "obstacle.2.shape.lower": [left, -0.05],
        "obstacle.2.shape.upper": [right, 0.0],
    }


def discharged(changes: dict[str, Any]) -> tuple[list[float], list[float]]:
    """Times [s], and the mass below the slot [kg/m]."""
    times, masses = [], []

    def observe(present: Simulation) -> None:
        (body,) = present.bodies
        times.append(present.time)
        masses.append(float(body.masses[body.positions[1] < 0.0].sum()))

    advance(shipped_simulation("hopper", changes), UNTIL, observe, intervals=32)
    return times, masses


def rate(found: tuple[list[float], list[float]]) -> float:
    """The rate of discharge while it is steady [kg/(m s)]."""
    times, masses = map(np.array, found)
    steady = times >= FROM
    return float(np.polyfit(times[steady], masses[steady], 1)[0])


def prefactor(discharge: float, opening: float) -> float:
    """Q/(rho sqrt(g) W^(3/2)) [1]."""
    return discharge / (DENSITY * math.sqrt(GRAVITY) * opening**1.5)


def measure(effort: Effort) -> Evidence:
    """Two heads and two openings, in full three, all of as many cells."""
    openings = OPENINGS if effort is Effort.FULL else OPENINGS[1:]
    runs = {width: discharged(silo(width, HEAD, width / CELLS_ACROSS)) for width in openings}
    found = {width: prefactor(rate(run), width) for width, run in runs.items()}
    mean = float(np.mean(list(found.values())))
    narrow = openings[0]
    lower = prefactor(rate(discharged(silo(narrow, LOWER_HEAD, narrow / CELLS_ACROSS))), narrow)
    scaling = tuple(
        scaled_error(f"Q/(rho sqrt(g) W^(3/2)), W = {width:g} m, against the mean", "1", one, mean, mean, BAND)
        for width, one in found.items()
    )
    head = scaled_error(f"the same from a head of {LOWER_HEAD:g} m", "1", lower, found[narrow], found[narrow], BAND)
    curves = tuple(curve(f"W = {width:g} m", *run) for width, run in runs.items())
    return Evidence((*scaling, head), figures=(Figure("Mass discharged", "time [s]", "mass [kg/m]", curves),))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """One slot resolved by a third of the cells of the other: the grid narrows it by a cell and a half."""
    width = OPENINGS[1]
    resolved = prefactor(rate(discharged(silo(width, HEAD, width / CELLS_ACROSS))), width)
    coarse = prefactor(rate(discharged(silo(width, HEAD, 3.0 * width / CELLS_ACROSS))), width)
    mean = 0.5 * (resolved + coarse)
    return (
        scaled_error("Q/(rho sqrt(g) W^(3/2)) of four cells across, against the mean", "1", coarse, mean, mean, BAND),
    )


CASE = Case(
    name="hopper_discharge",
    title="discharge of a flat silo through a slot",
    proves="sand flows through an opening between obstacles as it does through a slot: by its width, not by its head",
    reference="Q = C rho sqrt(g) W^(3/2) (Beverloo, Leniger & van de Velde 1961; Staron, Lagree & Popinet 2012)",
    norm="relative deviation of the prefactor from the mean over the openings, and between two heads",
    mistake="a slot of four cells in place of twelve",
    measure=measure,
    control=control,
)
