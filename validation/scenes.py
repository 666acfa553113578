"""Simulations for validation cases: a scene with changes, led to a time."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from grainlaw.materials import InputError
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.simulation import Simulation

SCENES = Path(__file__).resolve().parents[1] / "scenes"


def shipped_simulation(name: str, changes: dict[str, Any] | None = None) -> Simulation:
    """A shipped scene with values by dotted key set on top."""
    path = SCENES / f"{name}.toml"
    if not path.is_file():
        raise InputError(f"{path} is missing: this case needs a checkout, whose scenes it runs")
    return Simulation(Scene.load(path, changes))


def simulation_of(content: dict[str, Any]) -> Simulation:
    """The simulation of a scene given as nested dictionaries."""
    return Simulation(Scene.from_dict(content))


def advance(
    simulation: Simulation,
    end: float,
    observe: Callable[[Simulation], None] | None = None,
    intervals: int = 1,
) -> None:
    """Step to `end` [s], calling `observe` at the ends of equal intervals of time."""
    start = simulation.time
    for count in range(1, intervals + 1):
        simulation.advance_to(start + (end - start) * count / intervals)
        if observe is not None:
            observe(simulation)


def in_order_of_generation(body: Body, values: Any) -> Any:
    """Values of the points, shape (..., n), in the order in which the points were generated."""
    return values[..., np.argsort(body.ids)]
