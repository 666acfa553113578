"""Steady shear over a flat plane: its friction, and how fast the grains slip along it."""

import math
from pathlib import Path

import numpy as np

from grainlaw.validation.dem.cell import Reduced, write_table
from grainlaw.validation.dem.description import WallShear
from grainlaw.validation.dem.liggghts import template_texts
from grainlaw.validation.dem.packing import Array
from grainlaw.validation.dem.shear import StageBlocks, bulk, files, read_stage

__all__ = ["files", "reduce", "templates"]

TABLE = "wall_shear.csv"
# Height of the grains next to the plane, in mean diameters: their centres lie below it.
LAYER = 1.0
COLUMNS = (
    "slip_velocity",
    "slip_number",
    "inertial_number",
    "friction",
    "friction_error",
    "normal_stress",
    "pressure",
    "shear_stress",
    "solid_fraction",
    "top_velocity",
    "blocks",
)


def templates(code: str) -> dict[str, str]:
    """The texts of the templates that a run is made from."""
    return template_texts("contact_law.in.j2", "shear_cell.in.j2", "shear.in.j2")


def reduce(case: WallShear, folder: Path) -> Reduced:
    """Write the steady averages of every stage to a table; the friction is that of the plane, in equilibrium."""
    stages = [read_stage(folder, index) for index in range(len(case.stages))]
    write_table(folder / TABLE, COLUMNS, [_steady(case, stage) for stage in stages])
    return Reduced(stages[-1].steps, stages[-1].grains, TABLE)


def _steady(case: WallShear, stage: StageBlocks) -> list[object]:
    rows = np.array([_row(case, table, top) for table, top in zip(stage.tables, stage.tops, strict=False)])
    slip, fastest, rate_, phi, pressure, normal, shear = rows.mean(axis=0)
    friction = rows[:, 6] / rows[:, 5]
    speed = math.sqrt(normal / case.grains.density)
    values = (
        slip,
        slip / speed,
        rate_ * case.grains.mean_diameter / speed,
        shear / normal,
        friction.std(ddof=1) / math.sqrt(len(rows)),
        normal,
        pressure,
        shear,
        phi,
        fastest,
    )
    return [*(f"{value:.6g}" for value in values), len(rows)]


def _row(case: WallShear, block: Array, top: float) -> tuple[float, ...]:
    """Velocity next to the plane and of the highest grains, rate, solid fraction, p, sigma_zz and drag of the bulk."""
    rate_, phi, xx, yy, zz, xz, _ = bulk(case, block, top)
    z, count, along = block[:, 1], block[:, 2], block[:, 3]
    next_to_plane = (z > 0.0) & (z < LAYER * case.grains.mean_diameter)
    slip = float(np.average(along[next_to_plane], weights=count[next_to_plane]))
    highest = float(along[count > 0.0][-1])
    return slip, highest, rate_, phi, (xx + yy + zz) / 3.0, zz, xz
