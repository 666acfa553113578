"""Parameters of the laws from the shear and the compression of the grains; nothing is fitted to a collapse.

What a law is fitted to is written as data files for `grainlaw calibrate`, so that each fit can be repeated by hand.
Friction is taken over the mean pressure, as the laws define it; the grains show 6-10 % less over the normal stress.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from materials import InputError
from mpm_core.output import atomic
from validation.calibration.findings import Estimate, Findings
from validation.calibration.fit import Fit, calibrate
from validation.calibration.model import answer
from validation.dem_report.reference_set import ReferenceSet, Rows

SHEAR_FILE, SLOW_SHEAR_FILE, COMPRESSION_FILE = "shear.csv", "slow_shear.csv", "compression.csv"
# A law without rates is fitted where the friction of the grains hardly depends on them.
SLOW = 0.03
# Of the grains in the columns [Pa].
SMALLEST_PRESSURE, LARGEST_PRESSURE = 500.0, 10e3
COMPRESSION_POINTS = 30
# Standard error of the pressures of compression, which come without one [1].
PRESSURE_ERROR = 0.05
CURVE_POINTS = 12


@dataclass(frozen=True)
class JudgedLaw:
    """How a law is fitted and what limits it on this case.

    data    names of the files with its data
    given   values by name of what no element test tells, or what the grains themselves are; the rest is fitted
    """

    law: str
    title: str
    data: tuple[str, ...]
    given: dict[str, float]
    limits: str


@dataclass(frozen=True)
class FittedLaw:
    """A law with all its parameters, what the fit says, and the command that repeats it.

    curve   friction of the fitted law over the engineering inertial number
    """

    judged: JudgedLaw
    parameters: dict[str, float]
    estimates: tuple[Estimate, ...]
    remarks: tuple[str, ...]
    command: str
    curve: tuple[tuple[float, ...], tuple[float, ...]]


def write_data(reference: ReferenceSet, folder: Path, grain_density: float, grain_diameter: float) -> None:
    """Write the data files into a folder. Raises InputError if the reference set holds no shear."""
    if not reference.shear:
        raise InputError("the reference set holds no shear test to fit the laws to")
    folder.mkdir(parents=True, exist_ok=True)
    slow = [row for row in reference.shear if row["I"] <= SLOW * 1.2]
    for name, rows in ((SHEAR_FILE, reference.shear), (SLOW_SHEAR_FILE, slow)):
        atomic.write_text(folder / name, _shear_table(rows, grain_density, grain_diameter))
    if reference.compression:
        atomic.write_text(folder / COMPRESSION_FILE, _compression_table(reference.compression, grain_density))


def fitted(judged: JudgedLaw, folder: Path) -> FittedLaw:
    """Fit a law to its data files in a folder. Raises InputError or SimulationError if that cannot be done."""
    paths = [folder / name for name in judged.data if (folder / name).is_file()]
    findings = Findings(calibrate(judged.law, paths, fixed=judged.given))
    fixed = "".join(f" --fix {name}={value:g}" for name, value in judged.given.items())
    command = f"grainlaw calibrate {judged.law} {' '.join(path.name for path in paths)}{fixed}"
    return FittedLaw(judged, findings.fit.values, findings.estimates, findings.remarks, command, _curve(findings.fit))


def _curve(fit: Fit) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The friction that the law has in steady shear, over the range of the data."""
    shear = next(data for data in fit.model.data if data.experiment.name == "steady-shear")
    numbers = np.geomspace(shear.abscissa.min(), shear.abscissa.max(), CURVE_POINTS)
    friction = answer(fit.model.history(shear, fit.values, numbers), shear.measured[0])
    return tuple(numbers.tolist()), tuple(friction.tolist())


def friction_of_mean_pressure(row: dict[str, float]) -> tuple[float, float]:
    """tau/p of a row of plane shear, and its standard error."""
    friction = row["tau_over_p3"]
    return friction, row["se_mu"] * friction / row["mu"]


def _shear_table(rows: Rows, grain_density: float, grain_diameter: float) -> str:
    rows = sorted(rows, key=lambda row: row["I"])
    return _table(
        {
            "test": "steady-shear",
            "held_normal_stress": f"{np.mean([row['szz'] for row in rows]):.6g}",
            "grain_density": f"{grain_density:g}",
            "grain_diameter": f"{grain_diameter:.6g}",
        },
        (
            "engineering_inertial_number [1]",
            "friction_of_mean_pressure [1]",
            "standard_error_friction_of_mean_pressure [1]",
        ),
        [(row["I"], *friction_of_mean_pressure(row)) for row in rows],
    )


def _compression_table(rows: Rows, grain_density: float) -> str:
    first_seed = [row for row in rows if row["seed"] == rows[0]["seed"]]
    loading = first_seed[: int(np.argmax([row["p"] for row in first_seed])) + 1]
    used = [row for row in loading if SMALLEST_PRESSURE <= row["p"] <= LARGEST_PRESSURE]
    used = used[:: max(1, len(used) // COMPRESSION_POINTS)]
    first = used[0]
    return _table(
        {
            "test": "isotropic",
            "initial_pressure": f"{first['p']:.6g}",
            "density": f"{grain_density * first['phi']:.6g}",
            "grain_density": f"{grain_density:g}",
        },
        ("volumetric_strain [1]", "pressure [Pa]", "standard_error_pressure [Pa]"),
        [(np.log(row["phi"] / first["phi"]), row["p"], PRESSURE_ERROR * row["p"]) for row in used[1:]],
    )


def _table(statements: dict[str, str], names: Sequence[str], rows: Sequence[tuple[float, ...]]) -> str:
    lines = [f"# {name} = {value}" for name, value in statements.items()]
    lines += [",".join(names), *(",".join(f"{value:.6g}" for value in row) for row in rows)]
    return "\n".join(lines) + "\n"
