"""A cloud of opened material thrown together: no stress while its gaps close, then a collision."""

import numpy as np

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, relative_error, upper_bound
from grainlaw.validation.cases.hard.survival import NORM, SURVIVAL, notes, survivals, trial
from grainlaw.validation.scenes import DENSITY, PAPER, advance, one_body, simulation_of

STRESS_BAND, DENSITY_BAND, MOMENTUM_BAND = 1e-9, 1e-2, 1e-12
CENTER, RADIUS = np.array([[0.5], [0.5]]), 0.15
# Strain rate of opening and closing [1/s], and for how long [s]: a quarter more volume.
RATE, OPENING = 5.0, 0.025
# Free flight on the way in, as a share of the way out: the cloud must not have closed yet.
STILL_OPEN = 0.9
AFTERWARDS = 0.2
CELL = {Effort.QUICK: 0.025, Effort.FULL: 0.0125}
DISC = {"kind": "disc", "center": CENTER.ravel().tolist(), "radius": RADIUS}
MATERIALS = ("mu(I)-LC", "MCC OCR 4")
SPRING = ("linear_elastic", "soft_solid")


def throw(simulation: Simulation, rate: float) -> None:
    """Give the cloud the velocity rate (x - c)."""
    body = simulation.bodies[0]
    body.velocity = rate * (body.positions - CENTER)
    body.velocity_gradient = rate * np.eye(2)[:, :, None]
    simulation.measure_signals()


def opened(material: tuple[str, str], effort: Effort) -> Simulation:
    """The cloud after it was thrown apart."""
    simulation = simulation_of(one_body(material, DISC, CELL[effort], [1.0, 1.0]))
    throw(simulation, RATE)
    advance(simulation, OPENING)
    return simulation


def flight(label: str, material: tuple[str, str], effort: Effort) -> tuple[tuple[Measurement, ...], Simulation]:
    """Throw the cloud together at the rate that undoes the opening in the same time; measure before it closes."""
    simulation = opened(material, effort)
    body = simulation.bodies[0]
    rate = RATE / (1.0 + RATE * OPENING)
    throw(simulation, -rate)
    advance(simulation, OPENING + STILL_OPEN * OPENING)
    scale = DENSITY * (rate * RADIUS) ** 2
    stress = float(np.abs(body.stress).max())
    size = (1.0 + RATE * OPENING) * (1.0 - rate * STILL_OPEN * OPENING)
    exact = DENSITY / size**2
    inside = np.hypot(*(body.positions - CENTER)) < 0.7 * RADIUS
    found = float(body.density[inside].mean())
    return (
        upper_bound(f"{label}: stress in flight over rho v^2", "1", stress / scale, STRESS_BAND),
        relative_error(f"{label}: density in flight", "kg/m3", found, exact, DENSITY_BAND),
    ), simulation


def momentum(label: str, simulation: Simulation) -> Measurement:
    """The momentum of all points over the sum of its amounts before the throw."""
    body = simulation.bodies[0]
    total = float(np.abs(body.velocity.sum(axis=1)).max())
    return upper_bound(f"{label}: momentum", "1", total / (body.count * RATE * RADIUS), MOMENTUM_BAND)


def measure(effort: Effort) -> Evidence:
    """Both materials, in flight and through the collision."""
    measurements: list[Measurement] = []
    trials = {}
    for label in MATERIALS:
        found, simulation = flight(label, PAPER[label], effort)
        simulation.ledger.initial_kinetic = simulation.ledger.kinetic
        trials[label] = trial(simulation, simulation.time + AFTERWARDS)
        measurements += [*found, momentum(label, simulation)]
    return Evidence((*measurements, *survivals(trials)), notes=notes(trials))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A material that does not open."""
    found, _ = flight("linear elastic", SPRING, Effort.QUICK)
    return found


CASE = Case(
    name="thrown_cloud",
    title="loose cloud thrown together",
    proves="opened material carries nothing until its gaps have closed; a collision makes no energy",
    reference=f"no stress, rho_0 over the square of the size, momentum zero; {SURVIVAL}",
    norm=f"stress over rho v^2; relative error of the density; momentum over m v; {NORM}",
    mistake="a material with tension, linear elasticity",
    measure=measure,
    control=control,
)
