"""The files of a calibration: parameters for scenes and element tests, and everything that was found as JSON."""

import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from grainlaw.materials.atomic import write_text
from grainlaw.materials.calibration.findings import Findings
from grainlaw.materials.calibration.fit import ElementFit
from grainlaw.materials.calibration.parameter_file import parameter_file
from grainlaw.materials.calibration.told_by import told_by

PARAMETERS, RESULT, PICTURE = "parameters.toml", "calibration.json", "fit.png"


def write_files(findings: Findings, folder: Path, draw: Callable[[Path], None]) -> list[Path]:
    """Write parameters, result and the picture that `draw` makes into a new or present folder; return their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / PARAMETERS, parameter_file(findings))
    write_text(folder / RESULT, json.dumps(content(findings), indent=2) + "\n")
    draw(folder / PICTURE)
    return [folder / name for name in (PARAMETERS, RESULT, PICTURE)]


def content(findings: Findings) -> dict[str, Any]:
    """The calibration as plain values; an endless interval ends in null."""
    fit = findings.fit
    return {
        "law": fit.law.name,
        "data": list(fit.sources),
        "measurements": int(fit.residuals.size),
        "standard_errors_known": fit.knows_errors,
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
        "told_by": [asdict(found) for found in told_by(findings, fit.model)] if isinstance(fit, ElementFit) else [],
        "remarks": list(findings.remarks),
    }
