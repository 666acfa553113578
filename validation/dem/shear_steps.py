"""Shear of a packing at one speed after the other: friction and solid fraction over the strain of the bulk."""

import math
from pathlib import Path
from typing import Any

from grainlaw.validation.dem.cell import Reduced, write_table
from grainlaw.validation.dem.description import ShearStep, ShearSteps
from grainlaw.validation.dem.liggghts import contact_values, decks, template_texts
from grainlaw.validation.dem.shear import bulk, cell, rate, read_stage

Files = dict[str, str]
TABLE = "shear_steps.csv"
# Steps between two samples of a block.
EVERY = 10
COLUMNS = (
    "stage",
    "time",
    "strain",
    "inertial_number",
    "solid_fraction",
    "normal_stress",
    "pressure",
    "shear_stress",
)


def files(case: ShearSteps, seed: int) -> Files:
    """Deck and data of the run."""
    data, values = cell(case, seed)
    deck = decks().get_template("shear_steps.in.j2")
    return {
        "grains.data": data,
        "deck.in": deck.render(
            values,
            full_friction=contact_values(case.contact, case.contact.friction)["friction"],
            resting_steps=round(case.resting_time / case.time_step),
            steps=[_step(case, step) for step in case.steps],
            **contact_values(case.contact, case.packing_friction),
        ),
    }


def templates(code: str) -> Files:
    """The texts of the templates that a run is made from."""
    return template_texts("contact_law.in.j2", "shear_cell.in.j2", "shear_steps.in.j2")


def reduce(case: ShearSteps, folder: Path) -> Reduced:
    """Write stresses and solid fraction over time and strain of the bulk, at the middle of each block, to a table."""
    stages = [read_stage(folder, index) for index in range(len(case.steps))]
    rows = []
    time = strain = 0.0
    for index, (step, stage) in enumerate(zip(case.steps, stages, strict=True)):
        duration = _block(case, step) * case.time_step
        for table, top in zip(stage.tables, stage.tops, strict=False):
            rate_, phi, xx, yy, zz, xz, _ = bulk(case, table, top)
            number = abs(rate_) * case.grains.mean_diameter / math.sqrt(zz / case.grains.density)
            middle = (time + 0.5 * duration, strain + 0.5 * rate_ * duration)
            values = (*middle, number, phi, zz, (xx + yy + zz) / 3.0, xz)
            rows.append([index, *(f"{value:.6g}" for value in values)])
            time, strain = time + duration, strain + rate_ * duration
    write_table(folder / TABLE, COLUMNS, rows)
    return Reduced(sum(stage.steps for stage in stages), stages[-1].grains, TABLE)


def _step(case: ShearSteps, step: ShearStep) -> dict[str, Any]:
    block = _block(case, step)
    return {
        "nominal_inertial_number": step.nominal_inertial_number,
        "speed": rate(case, step.nominal_inertial_number) * case.height,
        "every": EVERY,
        "repeat": block // EVERY,
        "block": block,
        "blocks": round(step.strain / step.block_strain),
    }


def _block(case: ShearSteps, step: ShearStep) -> int:
    """Steps of a block, a multiple of `EVERY`."""
    steps = step.block_strain / (abs(rate(case, step.nominal_inertial_number)) * case.time_step)
    return EVERY * round(steps / EVERY)
