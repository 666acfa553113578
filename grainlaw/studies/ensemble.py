"""The runs of a prediction as scenes: draws of the parameters, and the estimate on other cells, steps and places."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from grainlaw.materials import InputError, Law
from grainlaw.mpm_core.scene.file import with_values
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.studies.batch import Member
from grainlaw.studies.draws import Draws

ESTIMATE, FINER, SHORTER = "estimate", "half-cells", "half-steps"
# Along the floor, over the distance of points: within the shapes, and evenly about the places of the scene.
SHIFTS = (-0.375, -0.125, 0.125, 0.375)
# Profiles need frames with velocities, as grains have, and nothing else.
OUTPUT: Mapping[str, Any] = {
    "output.fields": ["velocity"],
    "output.pictures": False,
    "output.vtu": True,
    "output.vtkhdf": False,
}


@dataclass(frozen=True)
class Plan:
    """A scene as content, with its output as a study needs it, and one of its materials whose parameters are set."""

    content: dict[str, Any]
    material: str

    def with_parameters(self, values: Mapping[str, float], changes: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """The scene with these parameters, and with values by dotted key on top."""
        content = with_values(self.content, changes or {})
        content["material"][self.material].update(values)
        return content


def plan(scene: Scene, law: Law, values: Mapping[str, float] | None = None) -> Plan:
    """A scene with parameters of its material of a law set. Raises InputError if it has none of it, or several."""
    material = material_of(scene, law)
    content = with_values(scene.model_dump(mode="json", exclude_none=True), OUTPUT)
    content["material"][material] = {"law": law.name, **scene.parameters(material)._asdict(), **(values or {})}
    return Plan(content, material)


def material_of(scene: Scene, law: Law) -> str:
    """The name of the one material of a law in a scene. Raises InputError if it has none of it, or several."""
    materials = [name for name in scene.material if scene.law(name).name == law.name]
    if len(materials) != 1:
        there = ", ".join(f"{name} ({scene.law(name).name})" for name in scene.material)
        raise InputError(f"{scene.source}: one material must be of the law {law.name}; there is {there}")
    return materials[0]


def drawn_members(plan: Plan, draws: Draws) -> list[Member]:
    """A run for each draw; names do not depend on their number, so that more draws go on with fewer."""
    return [
        Member(f"draw-{number:04}", plan.with_parameters(values)) for number, values in enumerate(draws.values, start=1)
    ]


def numerical_members(plan: Plan) -> list[Member]:
    """The estimate as it is, on half the cells, with half the steps, and at four places of its points within cells."""
    return [
        Member(name, plan.with_parameters({}, changes)) for name, changes in numerical_changes(plan.content).items()
    ]


def numerical_changes(content: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """What the runs that tell the numerical spread change in a scene, by their names.

    Around an axis points are rings, whose mass a shift along the floor would change: they keep their places.
    """
    time = content["time"]
    key = "time.step" if time.get("step") else "time.safety"
    found: dict[str, dict[str, Any]] = {
        ESTIMATE: {},
        FINER: {"grid.cell_size": 0.5 * content["grid"]["cell_size"]},
        SHORTER: {key: 0.5 * time[key.removeprefix("time.")]},
    }
    if content["space"] == "axisymmetric":
        return found
    axes = len(content["grid"]["lower"])
    for number, shift in enumerate(SHIFTS, start=1):
        along_floor = [*[shift] * (axes - 1), 0.0]
        found[f"place-{number}"] = {f"body.{body}.lattice_shift": along_floor for body in range(len(content["body"]))}
    return found
