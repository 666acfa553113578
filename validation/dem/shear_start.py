"""The start of shear of a dense packing: friction and solid fraction over the strain of the bulk."""

import csv
import io
import math
from pathlib import Path

import numpy as np

from grainlaw.materials.atomic import write_text
from grainlaw.validation.dem.cell import Reduced
from grainlaw.validation.dem.description import ShearStart
from grainlaw.validation.dem.liggghts import SETTLING_FRICTION, contact_values, decks, template_texts
from grainlaw.validation.dem.shear import bulk, cell, rate, read_profiles

Files = dict[str, str]
TABLE = "shear_start.csv"
EVERY = 10
COLUMNS = (
    "strain",
    "inertial_number",
    "solid_fraction",
    "normal_stress",
    "pressure",
    "shear_stress",
)


def files(case: ShearStart, seed: int) -> Files:
    """Deck and data of the run."""
    data, values = cell(case, seed)
    rate_ = rate(case, case.nominal_inertial_number)
    deck = decks().get_template("shear_start.in.j2")
    return {
        "grains.data": data,
        "deck.in": deck.render(
            values,
            full_friction=contact_values(case.contact, case.contact.friction)["friction"],
            resting_steps=round(case.resting_time / case.time_step / _block(case)) * _block(case),
            speed=rate_ * case.height,
            every=EVERY,
            repeat=_block(case) // EVERY,
            block=_block(case),
            blocks=round(case.final_strain / case.block_strain),
            **contact_values(case.contact, SETTLING_FRICTION),
        ),
    }


def templates(code: str) -> Files:
    """The texts of the templates that a run is made from."""
    return template_texts("contact_law.in.j2", "shear_cell.in.j2", "shear_start.in.j2")


def reduce(case: ShearStart, folder: Path) -> Reduced:
    """Write stresses and solid fraction over the strain of the bulk, at the middle of each block, to a table."""
    blocks = read_profiles(folder / "profile.txt")
    tops = np.loadtxt(folder / "height.txt", comments="#", ndmin=2)[:, 1]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    strain, duration = 0.0, _block(case) * case.time_step
    for (_, table), top in zip(blocks, tops, strict=False):
        rate_, phi, xx, yy, zz, xz, _ = bulk(case, table, top)
        number = rate_ * case.grains.mean_diameter / math.sqrt(zz / case.grains.density)
        values = (strain + 0.5 * rate_ * duration, number, phi, zz, (xx + yy + zz) / 3.0, xz)
        writer.writerow([f"{value:.6g}" for value in values])
        strain += rate_ * duration
    write_text(folder / TABLE, text.getvalue())
    return Reduced(blocks[-1][0], round(float(blocks[-1][1][:, 2].sum())), TABLE)


def _block(case: ShearStart) -> int:
    """Steps of a block, a multiple of `EVERY`."""
    steps = case.block_strain / (rate(case, case.nominal_inertial_number) * case.time_step)
    return EVERY * round(steps / EVERY)
