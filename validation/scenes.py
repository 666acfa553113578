"""Simulations for validation cases: a scene with changes, led to a time."""

from collections.abc import Callable
from typing import Any

import numpy as np

from grainlaw.materials import get_material
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.scene.shipped import shipped_scenes
from grainlaw.mpm_core.simulation import Simulation

# The paper's materials: a law and its parameter set.
PAPER = {
    "mu(I)-LC": ("mu_i_lc", "paper"),
    "MCC OCR 1": ("modified_cam_clay", "paper"),
    "MCC OCR 4": ("modified_cam_clay", "paper_ocr4"),
}
DENSITY = 1500.0


def shipped_simulation(name: str, changes: dict[str, Any] | None = None) -> Simulation:
    """A shipped scene with values by dotted key set on top."""
    return Simulation(Scene.load(shipped_scenes()[name], changes))


def simulation_of(content: dict[str, Any]) -> Simulation:
    """The simulation of a scene given as nested dictionaries."""
    return Simulation(Scene.from_dict(content))


def one_body(
    material: tuple[str, str], shape: dict[str, Any], cell_size: float, upper: list[float], **body: Any
) -> dict[str, Any]:
    """A scene without gravity and walls but the smooth ones: a shape of a law with a parameter set, 1500 kg/m3."""
    law, parameter_set = material
    return {
        "gravity": [0.0, 0.0],
        "grid": {"cell_size": cell_size, "upper": upper},
        "time": {"end": 1.0},
        "material": {law: get_material(law).parameter_sets[parameter_set].parameters._asdict()},
        "body": [{"material": law, "shape": shape, "density": DENSITY, **body}],
    }


def rectangle(x: float, y: float, width: float, height: float) -> dict[str, Any]:
    """A rectangle from its lower left corner [m]."""
    return {"kind": "rectangle", "lower": [x, y], "upper": [x + width, y + height]}


def block(lower: list[float], upper: list[float]) -> dict[str, Any]:
    """A rectangle, or in three dimensions a box, from its lower to its upper corner [m]."""
    return {"kind": "box" if len(lower) == 3 else "rectangle", "lower": lower, "upper": upper}


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
