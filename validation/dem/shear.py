"""Plane shear at constant normal stress: the deck, and steady averages with standard errors by blocks."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from grainlaw.validation.dem.cell import Reduced, write_table
from grainlaw.validation.dem.description import PlaneShear, ShearCell, ShearStage, SteadyShear, WallShear
from grainlaw.validation.dem.liggghts import contact_values, data_file, decks, template_texts
from grainlaw.validation.dem.packing import Array, Packing, loose, mean_volume, random_radii

Files = dict[str, str]
TABLE = "shear.csv"
LOOSE_FRACTION = 0.30
# Solid fraction at which the wall stops closing in and is pressed on; below that of any dense flow but the fastest.
CLOSED_FRACTION = 0.50
CLOSING_SPEED = 0.3
BLOCKS = 12
SAMPLES_PER_BLOCK = 100
# Share of the height that counts as the bulk.
BULK = (0.3, 0.7)
COLUMNS = (
    "inertial_number",
    "shear_rate",
    "mu",
    "mu_error",
    "solid_fraction",
    "solid_fraction_error",
    "normal_stress",
    "pressure",
    "shear_stress",
    "stress_xx",
    "stress_yy",
    "kinetic_share",
    "normal_stress_error",
    "height",
    "blocks",
)


def files(case: SteadyShear, seed: int) -> Files:
    """Deck and data of the run of all inertial numbers, the fastest first."""
    data, values = cell(case, seed)
    deck = decks().get_template("shear.in.j2")
    return {
        "grains.data": data,
        "deck.in": deck.render(
            values,
            stages=[_stage(case, stage) for stage in case.stages],
            **contact_values(case.contact, case.contact.friction),
        ),
    }


def cell(case: ShearCell, seed: int) -> tuple[str, dict[str, Any]]:
    """Data of a gas between two walls, and what a deck needs to press it together and to average over its height."""
    grains = case.grains
    random = np.random.default_rng(seed)
    area = case.length * case.depth
    number = round(0.58 * area * case.height / mean_volume(grains))
    gap = number * mean_volume(grains) / area / LOOSE_FRACTION
    space = np.array([[0.0, case.length], [0.0, case.depth], [0.0, gap]])
    gas = loose(random_radii(grains, number, random), space, (True, True, False), random)
    mean = grains.mean_diameter
    lower = rough_wall(case, random)
    upper = Packing(rough_wall(case, random).centres + np.array([0.0, 0.0, gap]), lower.radii)
    upper = Packing(upper.centres + np.array([0.0, 0.0, mean]), upper.radii)
    walls = upper
    if not isinstance(case, WallShear):
        walls = Packing(np.vstack([lower.centres - [0.0, 0.0, mean], upper.centres]), np.tile(lower.radii, 2))
    box = np.array([[0.0, case.length], [0.0, case.depth], [-3.0 * mean, gap + 3.0 * mean]])
    closing = gap * (1.0 - LOOSE_FRACTION / CLOSED_FRACTION)
    return data_file(gas, walls, grains.density, box), {
        "case": case,
        "seed": seed,
        "skin": 0.2 * mean,
        "middle": 0.5 * gap,
        "closing_speed": CLOSING_SPEED,
        "closing_steps": round(closing / CLOSING_SPEED / case.time_step),
        "force_per_grain": case.normal_stress * area / len(upper),
        "bin": 0.5 * mean,
        "flat": isinstance(case, WallShear),
    }


def rough_wall(case: ShearCell, random: np.random.Generator) -> Packing:
    """Equal grains about z = 0 in rows so close that no mobile grain fits between them, rough by random heights."""
    mean = case.grains.mean_diameter
    rows, columns = (int(side / (0.85 * mean)) for side in (case.length, case.depth))
    x, y = np.meshgrid(np.arange(rows) * case.length / rows, np.arange(columns) * case.depth / columns, indexing="ij")
    z = random.uniform(-0.25, 0.25, x.size) * mean
    return Packing(np.column_stack([x.ravel(), y.ravel(), z]), np.full(x.size, 0.5 * mean))


def templates(code: str) -> Files:
    """The texts of the templates that a run is made from."""
    return template_texts("contact_law.in.j2", "shear_cell.in.j2", "shear.in.j2")


def rate(case: ShearCell, inertial_number: float) -> float:
    """Nominal engineering shear rate [1/s]: I sqrt(sigma_zz/rho_p)/d."""
    return inertial_number * math.sqrt(case.normal_stress / case.grains.density) / case.grains.mean_diameter


def reduce(case: PlaneShear, folder: Path) -> Reduced:
    """Write the steady averages of every stage to `shear.csv`."""
    stages = [read_stage(folder, index) for index in range(len(case.stages))]
    write_table(folder / TABLE, COLUMNS, [_steady(case, stage) for stage in stages])
    return Reduced(stages[-1].steps, stages[-1].grains, TABLE)


def _stage(case: SteadyShear, stage: ShearStage) -> dict[str, Any]:
    rate_ = rate(case, stage.nominal_inertial_number)
    strain_per_step = rate_ * case.time_step
    every = max(1, round(stage.average_strain / strain_per_step / BLOCKS / SAMPLES_PER_BLOCK))
    block = every * SAMPLES_PER_BLOCK
    return {
        "nominal_inertial_number": stage.nominal_inertial_number,
        "speed": rate_ * case.height,
        "transient_steps": round(stage.transient_strain / strain_per_step),
        "every": every,
        "repeat": SAMPLES_PER_BLOCK,
        "block": block,
        "average_steps": block * (BLOCKS + 1),
    }


@dataclass(frozen=True)
class StageBlocks:
    """What a stage of shear left, block by block: averages over the height (rows of bin, z, count, values), height [m].

    steps   at the end, of the run
    grains  that move
    """

    tables: list[Array]
    tops: Array
    steps: int

    @property
    def grains(self) -> int:
        """Those of the last block."""
        return round(float(self.tables[-1][:, 2].sum()))


def read_stage(folder: Path, index: int) -> StageBlocks:
    """The blocks of a stage of a run."""
    blocks = _read_profiles(folder / f"profile_{index}.txt")
    tops = np.loadtxt(folder / f"height_{index}.txt", comments="#", ndmin=2)[:, 1]
    return StageBlocks([table for _, table in blocks], tops, blocks[-1][0])


def _read_profiles(path: Path) -> list[tuple[int, Array]]:
    """The blocks of a `fix ave/spatial` file: (step, rows of bin, z, count, values)."""
    lines = [line.split() for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    blocks, at = [], 0
    while at < len(lines):
        step, rows = int(lines[at][0]), int(lines[at][1])
        blocks.append((step, np.array(lines[at + 1 : at + 1 + rows], dtype=float)))
        at += rows + 1
    return blocks


def _steady(case: PlaneShear, stage: StageBlocks) -> list[float]:
    """Averages over the bulk of a stage's blocks, with standard errors from the scatter between blocks."""
    rows = np.array([bulk(case, block, top) for block, top in zip(stage.tables, stage.tops, strict=False)])
    mean = rows.mean(axis=0)
    rate_, phi, xx, yy, zz, xz, kinetic = mean
    mu_blocks = rows[:, 5] / rows[:, 4]
    root = math.sqrt(len(rows))
    error = rows.std(axis=0, ddof=1) / root
    pressure = (xx + yy + zz) / 3.0
    inertial = rate_ * case.grains.mean_diameter / math.sqrt(zz / case.grains.density)
    values = (
        inertial,
        rate_,
        xz / zz,
        mu_blocks.std(ddof=1) / root,
        phi,
        error[1],
        zz,
        pressure,
        xz,
        xx,
        yy,
        kinetic,
        error[4],
        float(np.mean(stage.tops)),
        len(rows),
    )
    return [float(f"{value:.6g}") for value in values]


def bulk(case: ShearCell, block: Array, top: float) -> tuple[float, ...]:
    """Rate, solid fraction, stresses xx, yy, zz (compression) and xz (drag along x), kinetic share of zz in a block."""
    height = top - 0.75 * case.grains.mean_diameter
    inside = (block[:, 1] > BULK[0] * height) & (block[:, 1] < BULK[1] * height)
    z, count = block[inside, 1], block[inside, 2]
    vx, vz, density, sxx, syy, szz, sxz, mxx, myy, mzz, mxz = block[inside, 3:14].T
    width = block[1, 1] - block[0, 1]
    per_volume = count / (case.length * case.depth * width)
    mass = density / per_volume
    kinetic = [mxx - mass * vx * vx, myy, mzz - mass * vz * vz, mxz - mass * vx * vz]
    contact = [-sxx, -syy, -szz, -sxz]
    total = [float(np.mean((c + k) * per_volume)) for c, k in zip(contact, kinetic, strict=True)]
    slope = float(np.polyfit(z, vx, 1, w=np.sqrt(count))[0])
    share = float(np.mean(kinetic[2] * per_volume)) / total[2]
    return (slope, float(np.mean(density)) / case.grains.density, total[0], total[1], total[2], -total[3], share)
