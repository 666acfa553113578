"""What the laws are fitted to: element tests of the grains as data files for `grainlaw calibrate`.

Friction is taken over the mean pressure, as the laws define it; the grains show 6-10 % less over the normal stress.
"""

import math
from pathlib import Path

import numpy as np

from grainlaw.materials import InputError, atomic
from grainlaw.validation.dem.judging.data_table import (
    FRACTION,
    FRICTION,
    NUMBER,
    STRAIN,
    by_seed,
    data_table,
    friction_of_mean_pressure,
    mean_and_error,
)
from grainlaw.validation.dem.judging.history_data import LOOSE_FILE, MEDIUM_FILE, history_tables
from grainlaw.validation.reference.reference_set import ReferenceSet, Rows

SHEAR_FILE, SLOW_SHEAR_FILE, COMPRESSION_FILE = "shear.csv", "slow_shear.csv", "compression.csv"
# Steady shear with its solid fraction; the same, said to start at the critical state of a Cam Clay; its start.
FLOW_FILE, CRITICAL_FLOW_FILE, START_FILE = "flow.csv", "critical_flow.csv", "shear_start.csv"
# The start of shear with its peak, and compression with unloading, of every packing.
PEAK_FILE, CYCLE_FILE = "shear_start_peak.csv", "compression_cycle.csv"
# A law without rates is fitted where the friction of the grains hardly depends on them.
SLOW = 0.036
# Of the grains in the columns [Pa].
SMALLEST_PRESSURE, LARGEST_PRESSURE = 500.0, 10e3
COMPRESSION_POINTS = 30
# Standard error of the pressures of compression, which come without one [1].
PRESSURE_ERROR = 0.05
# Past the rise of the stress, in which contacts are made, and up to where the bulk of every packing has been sheared.
START_STRAINS = np.linspace(0.04, 0.16, 7)
PEAK_STRAINS = np.array([0.02, 0.03, 0.04, 0.05, *START_STRAINS[1:]])
# Of packings that are not dense: their friction rises over a tenth.
LATE_STRAINS = np.linspace(0.02, 0.36, 18)


def write_data(reference: ReferenceSet, folder: Path, grain_density: float, grain_diameter: float) -> None:
    """Write the data files into a folder. Raises InputError if the reference set holds no shear."""
    shear, start, compression = (reference.test(name) for name in ("shear", "shear_start", "compression"))
    if not shear:
        raise InputError("the reference set holds no shear test to fit the laws to")
    folder.mkdir(parents=True, exist_ok=True)
    grains = {"grain_density": f"{grain_density:g}", "grain_diameter": f"{grain_diameter:.6g}"}
    steady = sorted(shear, key=lambda row: row["I"])
    slow = [row for row in steady if row["I"] <= SLOW]
    slow_density = grain_density * float(np.mean([row["phi"] for row in slow]))
    # Twice p is the size of Cam Clay's surface in the critical state; its softening needs shorter steps.
    critical = {"density": f"{slow_density:.6g}", "overconsolidation_ratio": "2", "strain_step": "1e-3"}
    texts = {
        SHEAR_FILE: _shear_table(steady, grains, with_fraction=False),
        SLOW_SHEAR_FILE: _shear_table(slow, grains, with_fraction=False),
        FLOW_FILE: _shear_table(steady, grains, with_fraction=True),
        CRITICAL_FLOW_FILE: _shear_table(steady, grains | critical, with_fraction=True),
        **history_tables(reference, grains),
    }
    if start:
        texts[START_FILE] = _start_table(start, grains, START_STRAINS)
        texts[PEAK_FILE] = _start_table(start, grains, PEAK_STRAINS)
    for name in (MEDIUM_FILE, LOOSE_FILE):
        rows = reference.test(name.removesuffix(".csv"))
        if rows:
            texts[name] = _start_table(rows, grains, LATE_STRAINS)
    if compression:
        texts[COMPRESSION_FILE] = _compression_table(compression, grain_density)
        texts[CYCLE_FILE] = _cycle_table(compression, grain_density)
    for name, text in texts.items():
        atomic.write_text(folder / name, text)


def _shear_table(rows: Rows, statements: dict[str, str], with_fraction: bool) -> str:
    stress = f"{np.mean([row['szz'] for row in rows]):.6g}"
    fraction = [(row["phi"], row["se_phi"]) if with_fraction else () for row in rows]
    return data_table(
        {"test": "steady-shear", "held_normal_stress": stress, **statements},
        (NUMBER, *FRICTION, *(FRACTION if with_fraction else ())),
        [(row["I"], *friction_of_mean_pressure(row), *own) for row, own in zip(rows, fraction, strict=True)],
    )


def _start_table(rows: Rows, statements: dict[str, str], strains: np.ndarray) -> str:
    """Means over the packings at common strains, with standard errors from their scatter."""
    seeds = by_seed(rows)
    measured: list[np.ndarray] = []
    for name in ("tau_over_p3", "phi"):
        measured += mean_and_error(np.array([_at_strains(seed, name, strains) for seed in seeds]))
    sheared = [row for row in rows if row["strain"] <= strains[-1]]
    density = float(statements["grain_density"]) * np.mean([seed[0]["phi"] for seed in seeds])
    # The law's own rate is half of the engineering one.
    number = 0.5 * np.mean([row["I"] for row in sheared])
    stress = np.mean([row["szz"] for row in sheared])
    own = {
        "test": "shear-start",
        "held_normal_stress": f"{stress:.6g}",
        "held_inertial_number": f"{number:.4g}",
        "density": f"{density:.6g}",
    }
    columns = np.column_stack([strains, *measured])
    return data_table(own | statements, (STRAIN, *FRICTION, *FRACTION), [tuple(row) for row in columns.tolist()])


def _at_strains(rows: Rows, name: str, at: np.ndarray) -> np.ndarray:
    """A quantity of one packing at the common strains; where the bulk turns back, what it was at first."""
    strains = np.maximum.accumulate([row["strain"] for row in rows])
    return np.interp(at, strains, [row[name] for row in rows])


def _compression_table(rows: Rows, grain_density: float) -> str:
    first_seed = [row for row in rows if row["seed"] == rows[0]["seed"]]
    loading = first_seed[: int(np.argmax([row["p"] for row in first_seed])) + 1]
    used = [row for row in loading if SMALLEST_PRESSURE <= row["p"] <= LARGEST_PRESSURE]
    used = used[:: max(1, len(used) // COMPRESSION_POINTS)]
    first = used[0]
    return data_table(
        {
            "test": "isotropic",
            "initial_pressure": f"{first['p']:.6g}",
            "density": f"{grain_density * first['phi']:.6g}",
            "grain_density": f"{grain_density:g}",
        },
        ("volumetric_strain [1]", "pressure [Pa]", "standard_error_pressure [Pa]"),
        [(np.log(row["phi"] / first["phi"]), row["p"], PRESSURE_ERROR * row["p"]) for row in used[1:]],
    )


def _cycle_table(rows: Rows, grain_density: float) -> str:
    """Compression to the largest pressure and back, each packing a test of its own; measured as in the columns."""
    lines = []
    for packing in by_seed(rows):
        top = int(np.argmax([row["p"] for row in packing]))
        first = next(row for row in packing if row["p"] >= SMALLEST_PRESSURE)
        for index, row in enumerate(packing):
            measured = row is not first and SMALLEST_PRESSURE <= row["p"] <= LARGEST_PRESSURE
            if measured or index == top:
                start = first["p"], grain_density * first["phi"], np.log(row["phi"] / first["phi"])
                lines.append((*start, *((row["p"], PRESSURE_ERROR * row["p"]) if measured else (math.nan, math.nan))))
    return data_table(
        {"test": "isotropic", "grain_density": f"{grain_density:g}", "strain_step": "2e-3"},
        (
            "initial_pressure",
            "density",
            "volumetric_strain [1]",
            "pressure [Pa]",
            "standard_error_pressure [Pa]",
        ),
        lines,
    )
