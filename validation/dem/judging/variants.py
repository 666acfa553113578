"""Runs with one thing changed: deliberate mistakes that the comparison must notice, and what limits a law."""

import copy
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from grainlaw.validation.grains.distance import Verdict


@dataclass(frozen=True)
class Variant:
    """The column of a law with one thing changed.

    factors     by which parameters of the law are multiplied, by name
    changes     values of the scene by dotted key
    cell_factor by which the cell size is multiplied
    grains      that it is judged against, whose column it is: their floor, and what else is different about them
    law         whose column it is
    aspect_ratio of the column
    noticed     of a mistake: the verdict from which on it counts as noticed
    """

    name: str
    says: str
    factors: Mapping[str, float] = field(default_factory=dict)
    changes: Mapping[str, Any] = field(default_factory=dict)
    cell_factor: float = 1.0
    grains: str = "glued"
    law: str = "mu_i_lc"
    aspect_ratio: float = 2.0
    noticed: Verdict = Verdict.DIFFERS


FRICTIONS = ("static_friction", "dynamic_friction")
NO_SLIP = {"boundary.bottom": "no_slip"}
ASPECT_RATIOS = (1.0, 2.0, 4.0, 6.0)


def _of_delayed_dilatancy(name: str, says: str, aspect_ratio: float, **changes: Any) -> Variant:
    return Variant(f"mu(I), phi(I), {name}", says, law="mu_i_phi_i", aspect_ratio=aspect_ratio, **changes)


def _of_state(name: str, says: str, aspect_ratio: float, **changes: Any) -> Variant:
    return Variant(f"mu(I), state, {name}", says, law="mu_i_state", aspect_ratio=aspect_ratio, **changes)


# A law that is near enough must lose its verdict by a mistake; gravity 12 makes it 10 % early and leaves the pile as it
# is, which no band of t50 that is twice 5 % wide can call more than that.
CONTROLS = (
    Variant("friction 30 % too low", "a wrong material", dict.fromkeys(FRICTIONS, 0.7)),
    Variant("gravity 12 m/s2", "a wrong clock", changes={"gravity": [0.0, -12.0]}),
    Variant("flat floor", "the right law against grains on a floor on which they roll", grains="flat"),
    *(
        _of_delayed_dilatancy(name, says, 2.0, noticed=Verdict.ACCEPTABLE, **mistake)
        for name, says, mistake in (
            ("friction 30 % too low", "a wrong material", {"factors": dict.fromkeys(FRICTIONS, 0.7)}),
            ("gravity 12 m/s2", "a wrong clock", {"changes": {"gravity": [0.0, -12.0]}}),
            ("flat floor", "a wrong floor", {"grains": "flat"}),
        )
    ),
    _of_state("friction 30 % too low", "a wrong material", 2.0, factors=dict.fromkeys(FRICTIONS, 0.7)),
    _of_state("gravity 12 m/s2", "a wrong clock", 2.0, noticed=Verdict.ACCEPTABLE, changes={"gravity": [0.0, -12.0]}),
    _of_state("no dilatancy", "strength and volume without packing", 2.0, factors={"dilatancy_coefficient": 0.0}),
    _of_state("all dilatancy in the friction", "N = 0", 2.0, factors={"hidden_dilatancy": 0.0}),
    _of_state("a = 6, points crowd", "no projection", 6.0, changes={"transfer.volume_projection": False}),
)

LIMITS = (
    Variant("mu(I)-LC, as judged", "the law itself, for comparison"),
    Variant("half the cell", "resolution: what is left to gain from a finer grid", cell_factor=0.5),
    Variant("twice the cell", "resolution: a coarser grid", cell_factor=2.0),
    Variant("no slip at the floor", "floor: rougher than a friction of 0.7", changes=NO_SLIP),
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
    _of_delayed_dilatancy("a = 2, as judged", "the law itself, for comparison", 2.0),
    _of_delayed_dilatancy(
        "a = 2, no dilatancy", "constant phi: what dilatancy is worth", 2.0, factors={"dilatancy_coefficient": 0.0}
    ),
    _of_delayed_dilatancy("a = 2, half the cell", "resolution", 2.0, cell_factor=0.5),
    _of_delayed_dilatancy("a = 6, as judged", "the law itself, for comparison", 6.0),
    _of_delayed_dilatancy("a = 6, twice the cell", "resolution", 6.0, cell_factor=2.0),
    _of_delayed_dilatancy("a = 6, half the cell", "resolution", 6.0, cell_factor=0.5),
    _of_delayed_dilatancy("a = 6, no slip at the floor", "floor", 6.0, changes=NO_SLIP),
    _of_state("a = 2, twice the cell", "resolution", 2.0, cell_factor=2.0),
    *(_of_state(f"a = {ratio:g}, half the cell", "resolution", ratio, cell_factor=0.5) for ratio in ASPECT_RATIOS),
    *(
        _of_state(
            f"a = {ratio:g}, flat floor",
            "the friction of the contacts, 0.7, for that of the plane",
            ratio,
            grains="flat",
        )
        for ratio in ASPECT_RATIOS
    ),
    # The modulus of a packing grows as that of its grains.
    _of_state("a = 2, stiff grains", "1e9 Pa", 2.0, grains="glued-stiff", factors={"stiffness": 10.0}),
    _of_state("a = 2, deep slot", "8 diameters for 4", 2.0, grains="glued-deep"),
    _of_state("a = 2, fine grains", "8 to 12 mm", 2.0, grains="glued-fine", factors={"grain_diameter": 10.0 / 15.0}),
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
            table = table.setdefault(parent, {})
        table[last] = value
    return scene
