"""LIGGGHTS decks of a case, as text, and the data files that they read."""

from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from grainlaw.validation.dem.description import Contact, RoughDrum, SlotHopper
from grainlaw.validation.dem.packing import Array, Packing

GRAIN, GLUED, PLANE, SMOOTH = 1, 2, 3, 4

# Friction between grains while the packing settles; low, so that it becomes dense.
SETTLING_FRICTION = 0.1
# Steps between two samples of what is averaged until the next output.
SAMPLE_STEPS = 20


@cache
def decks() -> Environment:
    """The deck templates that the package ships."""
    return Environment(
        loader=PackageLoader("grainlaw.validation.dem", "decks"),
        undefined=StrictUndefined,
        autoescape=False,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


def template_texts(*names: str) -> dict[str, str]:
    """The templates' own text, for the identity of a run."""
    loader = decks().loader
    assert loader is not None
    return {name: loader.get_source(decks(), name)[0] for name in names}


def contact_values(contact: Contact, friction: float) -> dict[str, Any]:
    """Coefficients between the four materials, row by row, for the deck's contact law."""
    arms = {GRAIN: 2.0, GLUED: 2.0, PLANE: 1.0, SMOOTH: 0.0}
    pairs = [(i, j) for i in range(1, 5) for j in range(1, 5)]
    return {
        "contact": contact,
        "friction": [0.0 if SMOOTH in pair else friction for pair in pairs],
        "rolling": [min(arms[i], arms[j]) * contact.rolling_arm for i, j in pairs],
    }


def output_steps(case: SlotHopper | RoughDrum) -> int:
    """Steps between two outputs, a multiple of `SAMPLE_STEPS`."""
    return SAMPLE_STEPS * round(case.output_interval / case.time_step / SAMPLE_STEPS)


def flow_values(case: SlotHopper | RoughDrum, seed: int, settling_time: float) -> dict[str, Any]:
    """For the deck of a packing that settles for a time [s] with low friction, is cut, relaxes, and then flows."""
    return contact_values(case.contact, SETTLING_FRICTION) | {
        "case": case,
        "seed": seed,
        "skin": 0.2 * case.grains.mean_diameter,
        "full_friction": contact_values(case.contact, case.contact.friction)["friction"],
        "settling_steps": round(settling_time / case.time_step),
        "relaxation_steps": round(case.relaxation / case.time_step),
        "sample_steps": SAMPLE_STEPS,
        "output_steps": output_steps(case),
    }


def data_file(grains: Packing, glued: Packing | None, density: float, box: Array) -> str:
    """A data file: mobile grains first (type 1), then the glued ones (type 2), in `box` (3, 2) [m]."""
    spheres = [(GRAIN, grains)] + ([] if glued is None else [(GLUED, glued)])
    lines = ["grains", "", f"{sum(len(group) for _, group in spheres)} atoms", "4 atom types", ""]
    lines += [f"{low:.9g} {high:.9g} {axis}lo {axis}hi" for (low, high), axis in zip(box, "xyz", strict=True)]
    lines += ["", "Atoms", ""]
    number = 0
    for kind, group in spheres:
        for (x, y, z), radius in zip(group.centres, group.radii, strict=True):
            number += 1
            lines.append(f"{number} {kind} {2 * radius:.9g} {density:.9g} {x:.9g} {y:.9g} {z:.9g}")
    return "\n".join(lines) + "\n"
