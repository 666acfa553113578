"""Two elastic discs collide in free space: momentum is exact, energy comes back."""

from typing import Any

import numpy as np

from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error, upper_bound
from grainlaw.validation.scenes import advance, shipped_simulation

MOMENTUM_BAND, ENERGY_BAND = 1e-12, 1e-2
END = 3.6
FULL_CELL = {"grid.cell_size": 0.025}


def momentum(simulation: Simulation) -> np.ndarray:
    """Of all points [kg/s]."""
    return np.sum([body.point_mass * body.velocity.sum(axis=1) for body in simulation.bodies], axis=0)


def collision(changes: dict[str, Any], scene: str = "two_discs") -> np.ndarray:
    """Rows of time [s], kinetic and elastic energy over the initial energy, change of momentum over that of a body."""
    simulation = shipped_simulation(scene, changes)
    first = simulation.bodies[0]
    start, initial = momentum(simulation), simulation.ledger.kinetic
    scale = float(first.point_mass * np.linalg.norm(first.velocity.sum(axis=1)))
    rows = [(0.0, 1.0, 0.0, 0.0)]

    def observe(present: Simulation) -> None:
        kinetic = present.ledger.kinetic
        elastic = present.elastic_energy()
        change = float(np.abs(momentum(present) - start).max())
        rows.append((present.time, kinetic / initial, elastic / initial, change / scale))

    advance(simulation, END, observe, intervals=72)
    return np.array(rows)


def measurements(label: str, rows: np.ndarray) -> tuple[Measurement, ...]:
    """Momentum at all times, and the energy that the collision leaves."""
    total = float(rows[-1, 1] + rows[-1, 2])
    return (
        upper_bound(f"change of momentum{label}", "1", float(rows[:, 3].max()), MOMENTUM_BAND),
        relative_error(f"kinetic and elastic energy after the collision{label}", "1", total, 1.0, ENERGY_BAND),
    )


def evidence(found: tuple[Measurement, ...], rows: np.ndarray) -> Evidence:
    """Measurements with the energies of a collision over time."""
    figure = Figure(
        "Energy over the initial energy",
        "time [s]",
        "energy [1]",
        (
            curve("exact sum", [0.0, END], [1.0, 1.0], "reference"),
            curve("sum", rows[:, 0], rows[:, 1] + rows[:, 2]),
            curve("kinetic", rows[:, 0], rows[:, 1]),
            curve("elastic", rows[:, 0], rows[:, 2]),
        ),
    )
    note = f"recovered: kinetic {rows[-1, 1]:.4f}, elastic (vibration) {rows[-1, 2]:.4f}; during contact the elastic "
    note += f"energy reaches {rows[:, 2].max():.4f}, the sum falls to {(rows[:, 1] + rows[:, 2]).min():.4f}"
    return Evidence(found, figures=(figure,), notes=(note,))


def measure(effort: Effort) -> Evidence:
    """The shipped scene; in full also on cells of half the size."""
    rows = collision({})
    found = measurements("", rows)
    if effort is Effort.FULL:
        found += measurements(", half the cell", collision(FULL_CELL))
    return evidence(found, rows)


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A transfer that drops the velocities below the grid's resolution."""
    return measurements("", collision({"transfer.scheme": "apic"}))


CASE = Case(
    name="two_discs",
    title="collision of two elastic discs",
    proves="transfers conserve momentum to round-off and take little energy; bodies meet without a contact model",
    reference="conservation of momentum and energy (set-up of Sulsky, Chen & Schreyer 1994: R 0.2 m, E 1000 Pa, "
    "nu 0.3, rho 1000 kg/m3, v 0.1 m/s along both axes, cells of 0.05 m)",
    norm="change over the momentum of a disc; missing share of the initial energy",
    mistake="pure APIC, which drops what the grid does not resolve in each step",
    measure=measure,
    control=control,
)
