"""Two bodies with exact answers, in both codes: a sphere that rolls to rest, two spheres that collide."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from grainlaw.validation.dem.collapse import ROLLING_STIFFNESS
from grainlaw.validation.dem.description import Contact
from grainlaw.validation.dem.liggghts import contact_values, data_file, decks
from grainlaw.validation.dem.packing import Packing
from grainlaw.validation.dem.programs import LIGGGHTS, PROGRAMS, run_program

RADIUS, DENSITY, GRAVITY, TIME_STEP = 0.0075, 2450.0, 9.81, 1e-5
SPEED, APPROACH = 0.3, 0.2
FIRST, LAST = 5000, 20000


@dataclass(frozen=True)
class TwoBody:
    """Deceleration of the rolling sphere [m/s2] and restitution of the head-on collision."""

    deceleration: float
    restitution: float


def exact(contact: Contact) -> TwoBody:
    """The answers: a moment of arm m r times the weight slows a rolling sphere by g m / (1 + 2/5)."""
    return TwoBody(GRAVITY * contact.rolling_arm / 1.4, contact.restitution)


def measured(code: str, contact: Contact, folder: Path) -> TwoBody:
    """Run the deck of a code in `folder`. Raises InputError if the code is missing, SimulationError if it fails."""
    program = PROGRAMS[code]
    places = np.array([[-0.05, 0.0, RADIUS], [-0.0085, 0.05, 0.5], [0.0085, 0.05, 0.5]])
    values = contact_values(contact, contact.friction) | {
        "radius": RADIUS,
        "density": DENSITY,
        "gravity": GRAVITY,
        "time_step": TIME_STEP,
        "speed": SPEED,
        "approach": APPROACH,
        "first": FIRST,
        "last": LAST,
        "places": places.tolist(),
        "rolling_stiffness": ROLLING_STIFFNESS,
    }
    if program is LIGGGHTS:
        box = np.array([[-0.2, 0.2], [-0.1, 0.1], [-0.01, 0.6]])
        data = data_file(Packing(places, np.full(3, RADIUS)), None, DENSITY, box)
        (folder / "grains.data").write_text(data, encoding="utf-8")
    deck, template = ("deck.in", "two_body.in.j2") if program is LIGGGHTS else ("deck.py", "two_body_yade.py.j2")
    (folder / deck).write_text(decks().get_template(template).render(values), encoding="utf-8")
    run_program(program, folder, deck, 120.0)
    start, end = (_speeds(folder / f"state_{number:07d}.txt") for number in (FIRST, LAST))
    return TwoBody((start[0] - end[0]) / ((LAST - FIRST) * TIME_STEP), (end[2] - end[1]) / (2.0 * APPROACH))


def _speeds(path: Path) -> list[float]:
    """Speeds along x of the three spheres, in the order of their numbers."""
    rows = [line.split() for line in path.read_text(encoding="utf-8").splitlines()]
    return [float(row[1]) for row in rows if len(row) == 2 and row[0] in ("1", "2", "3")]
