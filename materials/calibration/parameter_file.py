"""Files of parameters, and what a calibration leaves there for those who draw from it.

    static_friction = 0.489
    dynamic_friction = 0.706

    [calibration]
    law = "mu_i_lc"
    sources = ["shear.csv"]
    drawn = ["static_friction", "dynamic_friction"]
    logarithmic = [false, false]
    covariance = [[5.8e-5, -1.1e-4], [-1.1e-4, 2.3e-3]]
    held = []
    remarks = []

`covariance` is that of ln x where `logarithmic` says so, of x itself in SI units elsewhere. `degrees_of_freedom` stands
there where the scatter of the data had to tell their errors: draws are then of Student's distribution, else of the
normal one. `held` names parameters that were fitted but not determined; the covariance is that with them held.
Scenes and element tests read the values alone.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError, model_validator

from grainlaw.materials.calibration.findings import Findings
from grainlaw.materials.calibration.parameter_values import CALIBRATION, read_values
from grainlaw.materials.errors import InputError, nearest_name
from grainlaw.materials.faults import fault_in_words
from grainlaw.materials.law import Law
from grainlaw.materials.registry import get_material
from grainlaw.materials.toml_file import read_toml

Array = NDArray[np.float64]

# Of the largest eigenvalue: smaller negative ones are round-off of numbers written as text.
ROUND_OFF = 1e-9


class CalibrationTable(BaseModel):
    """The table of a calibration; see above."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    law: str
    sources: list[str]
    drawn: Annotated[list[str], Field(min_length=1)]
    logarithmic: list[bool]
    covariance: list[list[FiniteFloat]]
    degrees_of_freedom: Annotated[int, Field(gt=0)] | None = None
    held: list[str] = []
    remarks: list[str] = []

    @model_validator(mode="after")
    def _is_a_covariance(self) -> Self:
        size = len(self.drawn)
        if len(set(self.drawn)) < size:
            raise ValueError("drawn names a parameter twice")
        if len(self.logarithmic) != size:
            raise ValueError(f"logarithmic has {len(self.logarithmic)} entries, drawn has {size}")
        if [len(row) for row in self.covariance] != [size] * size:
            raise ValueError(f"covariance must have {size} rows of {size} numbers, as many as drawn names")
        matrix = np.array(self.covariance)
        if not np.allclose(matrix, matrix.T, rtol=1e-6, atol=0.0):
            raise ValueError("covariance is not symmetric")
        if np.any(np.diag(matrix) < 0.0) or not _is_positive(matrix):
            raise ValueError("covariance is none: a combination of parameters has a negative variance")
        return self


def _is_positive(matrix: Array) -> bool:
    """Whether no correlation has a negative eigenvalue, but for round-off."""
    deviations = np.sqrt(np.diag(matrix))
    scaled = matrix / np.outer(np.where(deviations > 0.0, deviations, 1.0), np.where(deviations > 0.0, deviations, 1.0))
    return bool(np.linalg.eigvalsh(scaled).min() >= -ROUND_OFF)


@dataclass(frozen=True)
class Calibrated:
    """What a calibration left: the law, the values of all its parameters by name, and the table above.

    source  the file, for messages
    """

    source: str
    law: Law
    values: dict[str, float]
    table: CalibrationTable


def parameter_file(findings: Findings) -> str:
    """All parameters of the law as TOML, each with the interval that it was found in, and what draws need."""
    fit = findings.fit
    notes = dict.fromkeys(fit.values, "not fitted")
    for found in findings.estimates:
        doubt = "" if found.determined else ", NOT DETERMINED by the data"
        notes[found.name] = f"95 %: {found.lower:.6g} to {found.upper:.6g}{doubt}"
    lines = [f"# {fit.law.name}, calibrated with {', '.join(fit.sources)}"]
    lines += [f"{name} = {float(value)!r}  # {notes[name]}" for name, value in fit.values.items()]
    if not findings.determined.any():
        return "\n".join([*lines, "# The data determine none of the parameters: there is nothing to draw from."]) + "\n"
    table = _table(findings).model_dump(exclude_none=True)
    # Lists, texts and numbers of JSON are those of TOML.
    rows = [f"{name} = {json.dumps(value)}" for name, value in table.items()]
    return "\n".join([*lines, "", f"[{CALIBRATION}]", *rows]) + "\n"


def calibrated_of(findings: Findings) -> Calibrated:
    """What a calibration leaves, without a file. At least one parameter must be determined."""
    return Calibrated(
        f"calibration of {findings.fit.law.name}", findings.fit.law, findings.fit.values, _table(findings)
    )


def _table(findings: Findings) -> CalibrationTable:
    fit = findings.fit
    drawn = [at for at, known in zip(fit.coordinates, findings.determined.tolist(), strict=True) if known]
    units = np.array([1.0 if at.logarithmic else at.scale for at in drawn])
    return CalibrationTable(
        law=fit.law.name,
        sources=list(fit.sources),
        drawn=[at.name for at in drawn],
        logarithmic=[at.logarithmic for at in drawn],
        covariance=(findings.covariance_of_determined * np.outer(units, units)).tolist(),
        degrees_of_freedom=None if fit.knows_errors else findings.freedom,
        held=[found.name for found in findings.estimates if not found.determined],
        remarks=list(findings.remarks),
    )


def read_calibrated(path: Path) -> Calibrated:
    """What a calibration left in its file of parameters. Raises InputError in one line for whatever is wrong in it."""
    content = read_toml(path, "parameter file")
    if not isinstance(content.get(CALIBRATION), dict):
        raise InputError(
            f"{path} has no table [{CALIBRATION}], from which draws are made; `grainlaw calibrate LAW DATA --out DIR` "
            "writes one, where the data determine a parameter"
        )
    table = _checked_table(path, content[CALIBRATION])
    try:
        law = get_material(table.law)
        values = law.checked(read_values(path), table.law)._asdict()
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    for name in (*table.drawn, *table.held):
        if name not in values:
            raise InputError(
                f"{path}: [{CALIBRATION}]: {table.law} has no parameter '{name}'; {nearest_name(name, values)}"
            )
    for name, logarithmic in zip(table.drawn, table.logarithmic, strict=True):
        if logarithmic and not values[name] > 0.0:
            raise InputError(
                f"{path}: {name} = {values[name]:g} has no logarithm, as [{CALIBRATION}] says; allowed: > 0"
            )
    return Calibrated(str(path), law, values, table)


def _checked_table(path: Path, content: dict[str, Any]) -> CalibrationTable:
    try:
        return CalibrationTable.model_validate(content)
    except ValidationError as error:
        # A misspelt key explains the missing one better than the other way round.
        faults = error.errors()
        fault = next((found for found in faults if found["type"] == "extra_forbidden"), faults[0])
        key = ".".join(str(part) for part in fault["loc"])
        if fault["type"] == "extra_forbidden":
            hint = nearest_name(key, CalibrationTable.model_fields)
            raise InputError(f"{path}: [{CALIBRATION}]: unknown key '{key}'; {hint}") from None
        raise InputError(f"{path}: [{CALIBRATION}]: {fault_in_words(fault, key)}") from None
