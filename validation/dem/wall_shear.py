"""Steady shear over a flat plane: its friction, and how fast the grains slip along it."""

import csv
import io
import math
from pathlib import Path

import numpy as np

from grainlaw.materials.atomic import write_text
from grainlaw.validation.dem.cell import Reduced
from grainlaw.validation.dem.description import WallShear
from grainlaw.validation.dem.liggghts import template_texts
from grainlaw.validation.dem.packing import Array
from grainlaw.validation.dem.shear import bulk, files, read_profiles

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
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    steps = grains = 0
    for index, _ in enumerate(case.stages):
        blocks = read_profiles(folder / f"profile_{index}.txt")
        tops = np.loadtxt(folder / f"height_{index}.txt", comments="#", ndmin=2)[:, 1]
        rows = np.array([_row(case, table, top) for (_, table), top in zip(blocks, tops, strict=False)])
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
        writer.writerow([*(f"{value:.6g}" for value in values), len(rows)])
        steps = blocks[-1][0]
        grains = round(float(blocks[-1][1][:, 2].sum()))
    write_text(folder / TABLE, text.getvalue())
    return Reduced(steps, grains, TABLE)


def _row(case: WallShear, block: Array, top: float) -> tuple[float, ...]:
    """Velocity next to the plane and of the highest grains, rate, solid fraction, p, sigma_zz and drag of the bulk."""
    rate_, phi, xx, yy, zz, xz, _ = bulk(case, block, top)
    z, count, along = block[:, 1], block[:, 2], block[:, 3]
    next_to_plane = (z > 0.0) & (z < LAYER * case.grains.mean_diameter)
    slip = float(np.average(along[next_to_plane], weights=count[next_to_plane]))
    highest = float(along[count > 0.0][-1])
    return slip, highest, rate_, phi, (xx + yy + zz) / 3.0, zz, xz
