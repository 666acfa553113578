"""What the laws are judged by beyond the start of shear of a dense packing: more element tests of grains as data files.

Other packings, drops and jumps of the rate, a reversal, other pressures, and triaxial compression.
"""

import math

import numpy as np

from grainlaw.validation.dem.judging.data_table import (
    FRACTION,
    FRICTION,
    NUMBER,
    STRAIN,
    TIME,
    by_seed,
    data_table,
    friction_of_mean_pressure,
    mean_and_error,
)
from grainlaw.validation.reference.reference_set import ReferenceSet, Rows

MEDIUM_FILE, LOOSE_FILE = "shear_start_medium.csv", "shear_start_loose.csv"
RATE_DROP_FILE, RATE_JUMP_FILE, SLOWING_FILE = "rate_drop.csv", "rate_jump.csv", "slowing.csv"
REVERSAL_FILE = "reversal.csv"
PRESSURE_FILE, TRIAXIAL_FILE = "pressures.csv", "triaxial.csv"
# Stages of the runs of shear at several rates.
DROP, JUMPS, SLOWING, TURNED = (1,), (2, 3), (4,), (2,)
# Axial strains, evenly spaced so that the rate is one.
AXIAL_STRAINS = np.linspace(0.0075, 0.18, 24)
TRIAXIAL_STEP = 1e-4


def history_tables(reference: ReferenceSet, grains: dict[str, str]) -> dict[str, str]:
    """Texts of the data files by name; a test that the reference set lacks is left out."""
    texts = {}
    steps, turned, triaxial = (reference.test(name) for name in ("shear_rate_steps", "shear_reversal", "triaxial"))
    if steps:
        texts[RATE_DROP_FILE] = _history_table(steps, grains, DROP)
        texts[SLOWING_FILE] = _history_table(steps, grains, SLOWING)
        texts[RATE_JUMP_FILE] = _history_table(steps, grains, JUMPS)
    if turned:
        texts[REVERSAL_FILE] = _history_table(turned, grains, TURNED)
    pressed = [*reference.test("shear_500Pa"), *reference.test("shear_50kPa")]
    if pressed:
        texts[PRESSURE_FILE] = _pressure_table(pressed, grains)
    if triaxial:
        texts[TRIAXIAL_FILE] = _triaxial_table(triaxial, grains)
    return texts


def _history_table(rows: Rows, grains: dict[str, str], stages: tuple[int, ...]) -> str:
    """Shear over time; friction and solid fraction count in some stages, the others lead there."""
    packings = by_seed(rows)
    # All runs of a case have their blocks at the same times.
    of_packings = {name: np.array([[row[name] for row in own] for own in packings]) for name in packings[0][0]}
    counted = np.isin(of_packings["stage"][0], stages)
    measured = [*mean_and_error(of_packings["tau_over_p3"]), *mean_and_error(of_packings["phi"])]
    own = {
        "test": "shear-history",
        "held_normal_stress": f"{np.mean([row['szz'] for row in rows]):.6g}",
        "density": f"{float(grains['grain_density']) * measured[2][0]:.6g}",
        "grain_density": grains["grain_density"],
    }
    columns = [
        of_packings["time"][0],
        of_packings["strain"].mean(axis=0),
        *(np.where(counted, values, math.nan) for values in measured),
    ]
    return data_table(own, (TIME, STRAIN, *FRICTION, *FRACTION), np.column_stack(columns).tolist())


def _pressure_table(rows: Rows, grains: dict[str, str]) -> str:
    """Steady shear at other pressures, each packing at each pressure a test of its own."""
    lines = []
    for row in rows:
        stress = float(f"{row['szz']:.6g}")
        density = float(grains["grain_density"]) * row["phi"]
        lines.append((stress, density, row["I"], *friction_of_mean_pressure(row), row["phi"], row["se_phi"]))
    names = ("held_normal_stress", "density", NUMBER, *FRICTION, *FRACTION)
    return data_table({"test": "steady-shear", **grains}, names, lines)


def _triaxial_table(rows: Rows, grains: dict[str, str]) -> str:
    """Means over the packings at common axial strains: q/p, and the volumetric strain since the start."""
    ratios, volumes = [], []
    for packing in by_seed(rows):
        strains = [row["strain"] for row in packing]
        ratio = [3.0 * (row["sa"] - row["sr"]) / (row["sa"] + 2.0 * row["sr"]) for row in packing]
        volume = [math.log(row["phi"] / packing[0]["phi"]) for row in packing]
        ratios.append(np.interp(AXIAL_STRAINS, strains, ratio))
        volumes.append(np.interp(AXIAL_STRAINS, strains, volume))
    start = [packing[0] for packing in by_seed(rows)]
    own = {
        "test": "triaxial-drained",
        "initial_pressure": f"{np.mean([(row['sa'] + 2.0 * row['sr']) / 3.0 for row in start]):.6g}",
        "density": f"{float(grains['grain_density']) * np.mean([row['phi'] for row in start]):.6g}",
        "grain_density": grains["grain_density"],
        "strain_rate": "0.1",
        "strain_step": f"{TRIAXIAL_STEP:g}",
    }
    names = ("axial_strain [1]", "stress_ratio [1]", "volumetric_strain [1]")
    columns = [AXIAL_STRAINS, np.mean(ratios, axis=0), np.mean(volumes, axis=0)]
    return data_table(own, names, np.column_stack(columns).tolist())
