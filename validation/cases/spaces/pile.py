"""The pile that a column or a cylinder leaves, measured in the same way in every space."""

import numpy as np

from grainlaw.mpm_core.output.middle import middle_of
from grainlaw.mpm_core.simulation import Simulation
from grainlaw.validation.case import Measurement, relative_error

# Of the mass, which a pile's reach and height enclose.
SHARE = 0.98


def pile(simulation: Simulation) -> dict[str, float]:
    """Reach and height that enclose nearly all of the mass, and the height of its centre [m].

    The reach counts from the middle, in two dimensions from x = 0.
    """
    body, middle = simulation.bodies[0], middle_of(simulation.scene)
    up, masses = body.positions[simulation.space.up], body.masses
    away = body.positions[0] if middle is None else middle.distance(body.positions)
    return {
        "reach": _enclosing(away, masses),
        "height": _enclosing(up, masses),
        "height of the centre of mass": float(np.average(up, weights=masses)),
    }


def _enclosing(values: np.ndarray, masses: np.ndarray) -> float:
    """The value below which `SHARE` of the mass lies."""
    order = np.argsort(values)
    below = np.cumsum(masses[order]) - 0.5 * masses[order]
    return float(np.interp(SHARE * masses.sum(), below, values[order]))


def differences_of_piles(
    found: dict[str, float], reference: dict[str, float], label: str, band: float
) -> tuple[Measurement, ...]:
    """Of two piles, relative to the second; `label` says which they are."""
    return tuple(relative_error(f"{label}: {name}", "m", value, reference[name], band) for name, value in found.items())
