"""From raw runs to the reference set: observations of collapses, tables of shear and compression, provenance."""

import csv
import io
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from grainlaw.materials import InputError
from grainlaw.materials.atomic import write_text
from grainlaw.validation.dem.drum import MEAN, MEAN_TABLE
from grainlaw.validation.dem.runs import RECORD
from grainlaw.validation.grains.observation import Observation, write_observation
from grainlaw.validation.grains.observe import observe_folder

Rows = Callable[[Path, dict[str, Any]], list[dict[str, Any]]]
COLLAPSES, PROVENANCE = "collapse", "provenance.json"
# The kinds of cases whose runs become observations.
RELEASES = ("collapse", "cylinder")
# Rows kept of a compression test: enough to fit slopes to, and a small file.
COMPRESSION_ROWS = 60
# A stage whose friction scatters more than this between blocks was still changing: steady ones stay below 0.01.
LARGEST_ERROR = 0.02


def reduce_runs(folder: Path, into: Path) -> list[Path]:
    """Write the reference set of all finished runs below `folder`; return the files written.

    Raises InputError if there is no finished run.
    """
    runs = [
        (path.parent, json.loads(path.read_text(encoding="utf-8"))) for path in sorted(folder.glob(f"*/*/{RECORD}"))
    ]
    if not runs:
        raise InputError(f"{folder} holds no finished run: no CASE/CODE-seedN/{RECORD}")
    (into / COLLAPSES).mkdir(parents=True, exist_ok=True)
    written = []
    for run, record in runs:
        if record["kind"] in RELEASES:
            path = into / COLLAPSES / f"{record['case']}_{record['code']}_s{record['seed']}.h5"
            observation = observe_folder(run)
            write_observation(path, observation if _shows_stress(record) else without_stress(observation))
            written.append(path)
    cells = [(run, record) for run, record in runs if record["kind"] in TABLES]
    for case in dict.fromkeys(record["case"] for _, record in cells):
        of_case = [(run, record) for run, record in cells if record["case"] == case]
        for name, rows_of in TABLES[of_case[0][1]["kind"]].items():
            path = into / table_name(f"{case}-{name}" if name else case)
            write_text(path, _table([row for run, record in of_case for row in rows_of(run, record)]))
            written.append(path)
    if cells:
        written.append(_write_provenance(into, cells))
    return written


def table_name(case: str) -> str:
    """Name of the file with the reduced data of all runs of a cell."""
    return f"{case.replace('-', '_')}.csv"


def without_stress(observation: Observation) -> Observation:
    """The observation without its stress fields, which are half of its file."""
    kept = {name: field for name, field in observation.snapshots.items() if not name.startswith("stress")}
    return replace(observation, snapshots=kept)


def _shows_stress(record: dict[str, Any]) -> bool:
    """Whether a run keeps its stress fields: the first packing of a case in each code does, for all of them."""
    return bool(record["seed"] == min(record["description"][f"{record['code']}_seeds"], default=record["seed"]))


def _write_provenance(into: Path, cells: list[tuple[Path, dict[str, Any]]]) -> Path:
    """Say what the tables were made from; what a table that is not made anew was made from stays."""
    path = into / PROVENANCE
    known = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    replaced = {record["case"] for _, record in cells}
    kept = {name: record for name, record in known.items() if record["case"] not in replaced}
    made = {f"{record['case']}/{run.name}": _provenance(record) for run, record in cells}
    write_text(path, json.dumps(kept | made, indent=1) + "\n")
    return path


def _shear_rows(run: Path, record: dict[str, Any]) -> list[dict[str, Any]]:
    """The steady states of a shear run; I is the engineering rate's with p = sigma_zz. Unsteady stages are left out."""
    rows = []
    for row in _read(run / record["table"]):
        value = {name: float(text) for name, text in row.items()}
        if value["mu_error"] > LARGEST_ERROR:
            continue
        rows.append(
            {
                "code": record["code"],
                "seed": record["seed"],
                "I": value["inertial_number"],
                "mu": value["mu"],
                "se_mu": value["mu_error"],
                "phi": value["solid_fraction"],
                "se_phi": value["solid_fraction_error"],
                "tau_over_p3": round(value["shear_stress"] / value["pressure"], 6),
                "szz": value["normal_stress"],
                "p3": value["pressure"],
                "sxx": value["stress_xx"],
                "syy": value["stress_yy"],
                "kin_frac": value["kinetic_share"],
                "blocks": int(value["blocks"]),
            }
        )
    return sorted(rows, key=lambda row: row["I"])


def _compression_rows(run: Path, record: dict[str, Any]) -> list[dict[str, Any]]:
    """Solid fraction and mean pressure, a few dozen of each stage, above the pressure at which loading starts."""
    start = record["description"]["start_pressure"]
    rows = [row for row in _read(run / record["table"]) if float(row["pressure"]) > start]
    chosen = []
    for stage in ("loading", "unloading"):
        part = [row for row in rows if row["stage"] == stage]
        step = max(1, len(part) // COMPRESSION_ROWS)
        chosen += part[::step]
    return [
        {
            "code": record["code"],
            "seed": record["seed"],
            "stage": row["stage"],
            "phi": row["solid_fraction"],
            "p": row["pressure"],
        }
        for row in chosen
    ]


def _shear_steps_rows(run: Path, record: dict[str, Any]) -> list[dict[str, Any]]:
    """Friction and solid fraction over time and strain, stage by stage; the first row tells how dense it was."""
    return [
        {
            "code": record["code"],
            "seed": record["seed"],
            "stage": row["stage"],
            "time": row["time"],
            "strain": row["strain"],
            "I": row["inertial_number"],
            "phi": row["solid_fraction"],
            "tau_over_p3": round(float(row["shear_stress"]) / float(row["pressure"]), 6),
            "szz": row["normal_stress"],
        }
        for row in _read(run / record["table"])
    ]


def _wall_shear_rows(run: Path, record: dict[str, Any]) -> list[dict[str, Any]]:
    """Friction of the plane over the slip along it, V/sqrt(sigma_zz/rho_p)."""
    rows = [
        {
            "code": record["code"],
            "seed": record["seed"],
            "slip": row["slip_number"],
            "I": row["inertial_number"],
            "mu": row["friction"],
            "se_mu": row["friction_error"],
            "phi": row["solid_fraction"],
            "tau_over_p3": round(float(row["shear_stress"]) / float(row["pressure"]), 6),
            "szz": row["normal_stress"],
            "slip_velocity": row["slip_velocity"],
            "top_velocity": row["top_velocity"],
        }
        for row in _read(run / record["table"])
    ]
    return sorted(rows, key=lambda row: float(row["slip"]))


def _triaxial_rows(run: Path, record: dict[str, Any]) -> list[dict[str, Any]]:
    """Stresses and solid fraction over the axial strain, from the isotropic state."""
    named = {"axial_strain": "strain", "solid_fraction": "phi", "axial_stress": "sa"}
    return [
        {
            "code": record["code"],
            "seed": record["seed"],
            **{short: row[name] for name, short in named.items()},
            "sr": round(0.5 * (float(row["stress_xx"]) + float(row["stress_yy"])), 2),
        }
        for row in _read(run / record["table"])
    ]


def _all_rows(run: Path, record: dict[str, Any]) -> list[dict[str, Any]]:
    """The table of a run as it is: of a hopper its mass over time, of a drum its surface and torque."""
    return [{"code": record["code"], "seed": record["seed"], **row} for row in _read(run / record["table"])]


def _mean_rows(run: Path, record: dict[str, Any]) -> list[dict[str, Any]]:
    """The mean profiles of a drum."""
    return _all_rows(run, record | {"table": MEAN_TABLE})


# The tables of each kind, by what is added to the name of the case.
TABLES: dict[str, dict[str, Rows]] = {
    "shear": {"": _shear_rows},
    "wall-shear": {"": _wall_shear_rows},
    "shear-steps": {"": _shear_steps_rows},
    "compression": {"": _compression_rows},
    "triaxial": {"": _triaxial_rows},
    "slot-hopper": {"": _all_rows},
    "rough-drum": {"": _all_rows, MEAN: _mean_rows},
}


def _provenance(record: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in record.items() if name not in ("frames", "table", "status")}


def _read(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _table(rows: list[dict[str, Any]]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()
