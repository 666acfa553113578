"""Runs with one thing changed: deliberate mistakes that the comparison must notice, and what limits a law."""

import copy
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Variant:
    """The column of the reference law with one thing changed.

    factors     by which parameters of the law are multiplied, by name
    changes     values of the scene by dotted key
    cell_factor by which the cell size is multiplied
    floor       of the grains that it is judged against
    """

    name: str
    says: str
    factors: Mapping[str, float] = field(default_factory=dict)
    changes: Mapping[str, Any] = field(default_factory=dict)
    cell_factor: float = 1.0
    floor: str = "glued"


FRICTIONS = ("static_friction", "dynamic_friction")

CONTROLS = (
    Variant("friction 30 % too low", "a wrong material", dict.fromkeys(FRICTIONS, 0.7)),
    Variant("gravity 12 m/s2", "a wrong clock", changes={"gravity": [0.0, -12.0]}),
    Variant("flat floor", "the right law against grains on a floor on which they roll", floor="flat"),
)

LIMITS = (
    Variant("as judged", "the law itself, for comparison"),
    Variant("half the cell", "resolution: what is left to gain from a finer grid", cell_factor=0.5),
    Variant("twice the cell", "resolution: a coarser grid", cell_factor=2.0),
    Variant("no slip at the floor", "floor: rougher than a friction of 0.7", changes={"boundary.bottom": "no_slip"}),
    Variant(
        "floor friction 0.35",
        "floor: smoother",
        changes={"boundary.bottom": {"kind": "friction", "coefficient": 0.35}},
    ),
    Variant(
        "friction over the normal stress",
        "convention: the friction of the grains is 6-10 % smaller over the normal stress than over the mean pressure",
        dict.fromkeys(FRICTIONS, 0.93),
    ),
    Variant(
        "friction 10 % higher",
        "missing dilatancy: a dense packing is stronger than its critical state until it has dilated",
        dict.fromkeys(FRICTIONS, 1.1),
    ),
    Variant("softer, K/4", "stiffness: the bulk modulus of the law", {"bulk_modulus": 0.25}),
)


def varied(scene: dict[str, Any], law: str, variant: Variant) -> dict[str, Any]:
    """The scene of a law with the change of a variant, but for the cell size."""
    scene = copy.deepcopy(scene)
    parameters = scene["material"][law]
    for name, factor in variant.factors.items():
        parameters[name] *= factor
    for key, value in variant.changes.items():
        *parents, last = key.split(".")
        table = scene
        for parent in parents:
            table = table[parent]
        table[last] = value
    return scene
