"""The paper's column set up as other codes had it, as changes of a shipped scene."""

import math
from typing import Any

from grainlaw.materials import get_material
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.scene.shipped import shipped_scenes

WIDTH, HEIGHT, LEFT = 0.3, 0.9, 1.45
DENSITY = 1500.0
LAYERS = 9

# The paper's code: cubic splines, and 0.5 % of the velocities below the grid's resolution lost in each step of 0.1 ms.
STEP = 1e-4
AS_HYDRAX = {
    "transfer.basis": "cubic",
    "transfer.time_constant": STEP / 0.005,
    "transfer.volume_projection": False,
}
DYNAMIC_FRICTION = "material.mu_i_lc_viscous.dynamic_friction"
PUBLISHED_FRICTION, FRICTION_OF_TABLE_1 = 3.7412297443487745, 1.2470765814495916
EXPLICIT = {**AS_HYDRAX, "time.step": STEP, DYNAMIC_FRICTION: PUBLISHED_FRICTION}
# Its masses are 25 to 50 % above the density behind the stress, 39 % in the mean over a stress that grows with depth.
HEAVIER = {**AS_HYDRAX, "body.0.density": 1.39 * DENSITY}


def drucker_prager(friction: float | None = None) -> dict[str, Any]:
    """The set `paper` of Drucker-Prager, whose friction A = sin(phi) is 0.6928, or another A."""
    parameters = get_material("drucker_prager").parameter_sets["paper"].parameters._asdict()
    if friction is not None:
        parameters["friction_angle"] = math.asin(friction)
    return {"material": {"drucker_prager": parameters}, "body.0.material": "drucker_prager"}


def one_preconsolidation_pressure() -> dict[str, Any]:
    """Cam Clay whose p_c is everywhere that of the normally consolidated bottom: layers, each with its OCR."""
    scene = Scene.load(shipped_scenes()["collapse_mcc_ocr1"]).model_dump(mode="json")
    (law,) = scene["material"]
    (body,) = scene["body"]
    materials, bodies = {}, []
    for number in range(LAYERS):
        low, high = HEIGHT * number / LAYERS, HEIGHT * (number + 1) / LAYERS
        name = f"layer_{number}"
        ratio = HEIGHT / (HEIGHT - 0.5 * (low + high))
        materials[name] = {"law": law, **scene["material"][law], "overconsolidation_ratio": ratio}
        shape = {"kind": "rectangle", "lower": [LEFT, low], "upper": [LEFT + WIDTH, high]}
        bodies.append({**body, "material": name, "shape": shape})
    return {"material": materials, "body": bodies}
