"""Drained triaxial compression of a periodic cube: the deck, and stresses and solid fraction over the axial strain."""

from pathlib import Path

import numpy as np

from grainlaw.validation.dem.cell import Reduced, write_table
from grainlaw.validation.dem.compression import finished_log, gas_in_a_cube, rows_of_log, solid_volume
from grainlaw.validation.dem.description import Triaxial
from grainlaw.validation.dem.liggghts import contact_values, decks, template_texts

Files = dict[str, str]
TABLE = "triaxial.csv"
COLUMNS = ("axial_strain", "solid_fraction", "axial_stress", "stress_xx", "stress_yy")
# Rate at which the gas is closed [1/s]; steps between two changes of the sides' rates.
FAST_RATE = 0.5
EVERY = 50
# Share of a stress that a side's rate takes up within `EVERY` steps at the stiffness of the packing [Pa], about.
SHARE, STIFFNESS = 0.3, 6e5
# Pressure of the first contacts [Pa]; steps in which the gas comes to rest.
START_PRESSURE, QUIET = 500.0, 5000
# Rows of the log in one row of the table.
AVERAGED = 20


def files(case: Triaxial, seed: int) -> Files:
    """Deck and data of the run."""
    data = gas_in_a_cube(case, seed)
    deck = decks().get_template("triaxial.in.j2")
    period = EVERY * case.time_step
    return {
        "grains.data": data,
        "deck.in": deck.render(
            case=case,
            seed=seed,
            skin=0.2 * case.grains.mean_diameter,
            fast_rate=FAST_RATE,
            every=EVERY,
            start_pressure=START_PRESSURE,
            quiet=QUIET,
            gain=SHARE / STIFFNESS / period,
            resting_rounds=round(case.resting_time / period),
            rounds=round(case.final_strain / case.axial_rate / period),
            full_friction=contact_values(case.contact, case.contact.friction)["friction"],
            **contact_values(case.contact, case.packing_friction),
        ),
    }


def templates(code: str) -> Files:
    """The texts of the templates that a run is made from."""
    return template_texts("contact_law.in.j2", "triaxial.in.j2")


def reduce(case: Triaxial, folder: Path) -> Reduced:
    """Write stresses and solid fraction over the logarithmic axial strain to a table, the state at rest first."""
    resting, _, shearing = finished_log(folder).partition("\nSHEARING")
    start = rows_of_log(resting, 8)[-1]
    rows = np.array(rows_of_log(shearing, 8))
    rows = rows[: len(rows) // AVERAGED * AVERAGED].reshape(-1, AVERAGED, 7).mean(axis=1)
    solid = solid_volume(folder / "grains.data")
    table = [
        (np.log(start[3] / height), solid / volume, zz, xx, yy)
        for _, _, volume, height, xx, yy, zz in (start, *rows.tolist())
    ]
    write_table(folder / TABLE, COLUMNS, [[f"{value:.6g}" for value in values] for values in table])
    return Reduced(int(rows_of_log(shearing, 8)[-1][0]), int(start[1]), TABLE)
