"""The files of a calibration: parameters for scenes and element tests, and everything that was found as JSON."""

import json
from pathlib import Path
from typing import Any

from grainlaw.materials.atomic import write_text
from grainlaw.materials.calibration.findings import Findings

PARAMETERS, RESULT, PICTURE = "parameters.toml", "calibration.json", "fit.png"


def write_files(findings: Findings, folder: Path) -> list[Path]:
    """Write parameters, result and picture into a folder, which is created; return their paths."""
    from grainlaw.materials.calibration.figures import draw

    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / PARAMETERS, parameter_file(findings))
    write_text(folder / RESULT, json.dumps(content(findings), indent=2) + "\n")
    draw(findings, folder / PICTURE)
    return [folder / name for name in (PARAMETERS, RESULT, PICTURE)]


def parameter_file(findings: Findings) -> str:
    """All parameters of the law as TOML, each with the interval that it was found in."""
    fit = findings.fit
    files = ", ".join(data.label for data in fit.model.data)
    notes = dict.fromkeys(fit.values, "not fitted")
    for found in findings.estimates:
        doubt = "" if found.determined else ", NOT DETERMINED by the data"
        notes[found.name] = f"95 %: {found.lower:.6g} to {found.upper:.6g}{doubt}"
    lines = [f"# {fit.model.law.name}, calibrated with {files}"]
    lines += [f"{name} = {float(value)!r}  # {notes[name]}" for name, value in fit.values.items()]
    return "\n".join(lines) + "\n"


def content(findings: Findings) -> dict[str, Any]:
    """The calibration as plain values; an endless interval ends in null."""
    fit = findings.fit
    return {
        "law": fit.model.law.name,
        "data": [data.label for data in fit.model.data],
        "measurements": int(fit.residuals.size),
        "standard_errors_known": fit.model.knows_errors,
        "weighted_sum_of_squares": findings.misfit,
        "degrees_of_freedom": findings.freedom,
        "converged": fit.converged,
        "estimates": [
            {
                "name": found.name,
                "unit": found.unit,
                "value": found.value,
                "interval_95": [found.lower, found.upper if found.upper < float("inf") else None],
                "determined": found.determined,
            }
            for found in findings.estimates
        ],
        "correlation": findings.correlation.tolist(),
        "not_fitted": {
            name: value
            for name, value in fit.values.items()
            if name not in {found.name for found in findings.estimates}
        },
        "remarks": list(findings.remarks),
    }
