"""The collapse of a column: settle, cut, relax, release; what each code is given."""

from functools import cache

import numpy as np

from grainlaw.validation.dem.geometry import MARGIN, Column, geometry_of, glued_grains
from grainlaw.validation.dem.liggghts import SETTLING_FRICTION, contact_values, data_file, decks, template_texts
from grainlaw.validation.dem.packing import (
    GLUED_DEPTH,
    Array,
    Packing,
    mean_volume,
    random_radii,
)

LOOSE_FRACTION = 0.27
# Dense enough for any settled packing, and a tenth of the height to cut off.
FILL = 0.64 * 1.1
# Time [s] for which the grains settle after the highest one has reached the floor.
SETTLING_TIME = 0.5
# YADE's rolling spring is a constant [N m/rad]; epsd2 takes the tangential stiffness times the square of the effective
# radius, which is this much for 15 mm grains that carry 0.3 N, the load in the middle of a 0.3 m column.
ROLLING_STIFFNESS = 0.3

Files = dict[str, str]


@cache
def floor_of(case: Column, seed: int) -> tuple[Packing | None, float]:
    """The glued grains (None on a flat floor) and the level of the plane below them [m]."""
    if case.floor == "flat":
        return None, 0.0
    random = np.random.default_rng([seed, 1])
    layer = glued_grains(case, random)
    depth = GLUED_DEPTH * case.grains.mean_diameter
    return Packing(layer.centres - [0.0, 0.0, depth], layer.radii), -depth - case.grains.largest_diameter / 2.0


def settling_files(case: Column, seed: int) -> Files:
    """Deck and data of the LIGGGHTS run that makes the packing (written to `packing.txt`)."""
    random = np.random.default_rng(seed)
    geometry = geometry_of(case)
    number = round(FILL * geometry.base * case.initial_height / mean_volume(case.grains))
    top = number * mean_volume(case.grains) / geometry.base / LOOSE_FRACTION
    low = 0.5 * case.grains.mean_diameter
    falling = geometry.loose_grains(random_radii(case.grains, number, random), low, top + low, random)
    fall = np.sqrt(2.0 * top / case.gravity)
    deck = decks().get_template("settle.in.j2")
    return {
        "grains.data": data_file(falling, floor_of(case, seed)[0], case.grains.density, geometry.box(top + low)),
        "deck.in": deck.render(
            **_common(case, seed, SETTLING_FRICTION), thermo=2000, steps=round((fall + SETTLING_TIME) / case.time_step)
        ),
    }


def release_files(case: Column, code: str, seed: int, packing: Packing) -> Files:
    """Deck and data of the run that relaxes and releases the cut `packing` in one of the codes."""
    glued = floor_of(case, seed)[0]
    values = _common(case, seed, case.contact.friction) | {
        "relaxation_steps": round(case.relaxation / case.time_step),
        "output_steps": output_steps(case),
        "outputs": outputs(case),
    }
    if code == "liggghts":
        box = geometry_of(case).box(case.initial_height + MARGIN)
        return {
            "grains.data": data_file(packing, glued, case.grains.density, box),
            "deck.in": decks().get_template("collapse.in.j2").render(values),
        }
    return {
        "grains.txt": _table(packing, glued),
        "deck.py": decks().get_template("collapse_yade.py.j2").render(values, rolling_stiffness=ROLLING_STIFFNESS),
    }


def templates(code: str) -> Files:
    """The texts of the templates that a code's run is made from."""
    release = "collapse.in.j2" if code == "liggghts" else "collapse_yade.py.j2"
    return template_texts("contact_law.in.j2", "settle.in.j2", release)


def output_steps(case: Column) -> int:
    """Steps between two outputs."""
    return round(case.output_interval / case.time_step)


def outputs(case: Column) -> int:
    """Number of outputs after the one at the release."""
    return round(case.end / case.output_interval)


def _common(case: Column, seed: int, friction: float) -> dict[str, object]:
    geometry = geometry_of(case)
    return {
        "case": case,
        "seed": seed,
        "boundary": geometry.boundary,
        "walls": geometry.walls,
        "with_contacts": geometry.with_contacts,
        "dumped": "all" if geometry.with_contacts else "mobile",
        "skin": 0.2 * case.grains.mean_diameter,
        "glued": case.floor == "glued",
        "floor_level": floor_of(case, seed)[1],
        **contact_values(case.contact, friction),
    }


def _table(packing: Packing, glued: Packing | None) -> str:
    lines = ["# id type x y z radius"]
    groups = [(1, packing)] + ([] if glued is None else [(2, glued)])
    spheres = [(kind, *centre, radius) for kind, group in groups for *centre, radius in _rows(group)]
    lines += [
        f"{number} {kind} {x:.9g} {y:.9g} {z:.9g} {radius:.9g}"
        for number, (kind, x, y, z, radius) in enumerate(spheres, 1)
    ]
    return "\n".join(lines) + "\n"


def _rows(packing: Packing) -> Array:
    return np.column_stack([packing.centres, packing.radii])
