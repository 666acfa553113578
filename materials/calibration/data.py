"""Reading a data file of element tests.

    # test = triaxial-drained
    # initial_pressure = 200e3
    axial_strain [1],deviatoric_stress [Pa],standard_error_deviatoric_stress [Pa],volumetric_strain [1]
    0.01,81e3,2e3,0.004

A line `# name = value` before the header states the test, one of its settings or a parameter of the law, in SI units;
other lines that begin with # are remarks. The same names may head columns instead: rows that agree in them form one
test each. One column drives the test (`experiments`), the others were measured (`quantities`); cells may be empty.
"""

import csv
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, Law
from grainlaw.materials.calibration.experiments import EXPERIMENTS, Control, Experiment, get_experiment
from grainlaw.materials.calibration.quantities import QUANTITIES
from grainlaw.materials.errors import nearest_name

Array = NDArray[np.float64]
Cells = dict[str, str]

TEST = "test"
ERROR_PREFIX = "standard_error_"
_STATEMENT = re.compile(r"#\s*([A-Za-z_]\w*)\s*=\s*(.+?)\s*")
_HEADING = re.compile(r"\s*(\w+)\s*(?:\[([^\]]*)\])?\s*")


@dataclass(frozen=True)
class Measured:
    """A measured column: values and their standard errors if known, shape (rows,); NaN where nothing was measured."""

    name: str
    values: Array
    standard_errors: Array | None


@dataclass(frozen=True)
class DataSet:
    """The data of one test.

    label       the file, and the values by which its tests differ if it holds several
    control     name of the column that drives the test
    abscissa    its values, shape (rows,)
    statements  settings of the test and parameters of the law that the file states, by name
    file        its name
    followed    if the control is time, the driven values of the law at these times, shape (rows,)
    """

    label: str
    experiment: Experiment
    control: str
    abscissa: Array
    statements: dict[str, float]
    measured: tuple[Measured, ...]
    file: str = ""
    followed: Array | None = None

    def driven(self, abscissa: Array) -> Array:
        """Values of the column that drives the test in the law's own terms; times with what is followed, (rows, 2)."""
        driven = self.experiment.controls[self.control].driven(abscissa)
        if self.followed is None:
            return driven
        over_time = np.interp(abscissa, [0.0, *self.abscissa], [0.0, *self.followed])
        return np.column_stack([driven, over_time])


@dataclass
class _Table:
    path: Path
    statements: dict[str, str] = field(default_factory=dict)
    names: list[str] = field(default_factory=list)
    units: dict[str, str | None] = field(default_factory=dict)
    rows: list[tuple[int, Cells]] = field(default_factory=list)

    def fault(self, text: str, line: int | None = None) -> InputError:
        return InputError(f"{self.path}{'' if line is None else f', line {line}'}: {text}")


def read_data(path: Path, law: Law) -> list[DataSet]:
    """The tests of a data file. Raises InputError, in one line, for the first fault."""
    table = _read_table(path)
    grouping = [name for name in table.names if name == TEST or _is_statement(name, law)]
    found = []
    for values, rows in groupby(table.rows, lambda row: tuple(row[1][name] for name in grouping)):
        own = dict(zip(grouping, values, strict=True))
        twice = next((name for name in own if name in table.statements), None)
        if twice:
            raise table.fault(f"'{twice}' is both a statement before the header and a column")
        label = " ".join([path.name, *(f"{name} = {value}" for name, value in own.items())])
        found.append(_data_set(table, label, {**table.statements, **own}, list(rows), grouping, law))
    return found


def _is_statement(name: str, law: Law) -> bool:
    settings = {key for experiment in EXPERIMENTS.values() for key in experiment.settings._fields}
    return name in settings or name in law.parameter_declarations


def _read_table(path: Path) -> _Table:
    table = _Table(path)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"data file {path} cannot be read: {error}") from error
    for number, line in enumerate(lines, start=1):
        if line.startswith("#"):
            # A spreadsheet pads short lines with commas.
            statement = _STATEMENT.fullmatch(line.rstrip(", "))
            if statement and not table.names:
                table.statements[statement[1]] = statement[2]
            continue
        cells = next(csv.reader([line]), [])
        if not any(cell.strip() for cell in cells):
            continue
        if not table.names:
            _read_header(table, cells, number)
        elif len(cells) != len(table.names):
            raise table.fault(f"{len(cells)} cells under {len(table.names)} headings", number)
        else:
            table.rows.append((number, dict(zip(table.names, (cell.strip() for cell in cells), strict=True))))
    if not table.rows:
        raise table.fault("no data: expected a header such as 'axial_strain [1],deviatoric_stress [Pa]' and rows below")
    return table


def _read_header(table: _Table, cells: Sequence[str], line: int) -> None:
    for cell in cells:
        heading = _HEADING.fullmatch(cell)
        if heading is None:
            raise table.fault(f"heading '{cell.strip()}' is not of the form 'name [unit]'", line)
        if heading[1] in table.names:
            raise table.fault(f"two columns are named '{heading[1]}'", line)
        table.names.append(heading[1])
        table.units[heading[1]] = heading[2]


def _data_set(
    table: _Table, label: str, stated: dict[str, str], rows: list[tuple[int, Cells]], grouping: list[str], law: Law
) -> DataSet:
    if TEST not in stated:
        raise table.fault(f"no test; begin the file with '# test = NAME', NAME among {', '.join(EXPERIMENTS)}")
    try:
        experiment = get_experiment(stated[TEST])
    except InputError as error:
        raise table.fault(str(error)) from None
    statements = {name: _stated_number(table, name, text) for name, text in stated.items() if name != TEST}
    known = {**experiment.settings._field_defaults, **law.parameter_declarations}
    for name in statements:
        if name not in known:
            raise table.fault(
                f"'{name}' is neither a setting of {experiment.name} nor of {law.name}; {nearest_name(name, known)}"
            )
    control = _control(table, experiment, experiment.controls)
    abscissa = _filled_column(table, control, rows)
    if not experiment.follows:
        measured = _measured(table, experiment, [control, *grouping], rows)
        return DataSet(label, experiment, control, abscissa, statements, measured, table.path.name)
    name = _control(table, experiment, experiment.follows)
    measured = _measured(table, experiment, [control, name, *grouping], rows)
    falls = ~(np.diff(abscissa, prepend=0.0) > 0.0)
    if np.any(falls):
        raise table.fault(f"{control} must rise from row to row, from above 0", rows[int(np.argmax(falls))][0])
    followed = experiment.follows[name].driven(_filled_column(table, name, rows))
    return DataSet(label, experiment, control, abscissa, statements, measured, table.path.name, followed)


def _stated_number(table: _Table, name: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise table.fault(f"{name} = {text}: '{text}' is not a number (SI units, no unit behind it)") from None


def _control(table: _Table, experiment: Experiment, choices: Mapping[str, Control]) -> str:
    present = [name for name in table.names if name in choices]
    if len(present) != 1:
        raise table.fault(f"{experiment.name} needs one column {' or '.join(choices)}, not {len(present)}")
    _check_unit(table, present[0], choices[present[0]].unit)
    return present[0]


def _measured(
    table: _Table, experiment: Experiment, others: Sequence[str], rows: list[tuple[int, Cells]]
) -> tuple[Measured, ...]:
    names = [name for name in table.names if name not in others]
    measured = [name for name in names if not name.startswith(ERROR_PREFIX)]
    for name in names:
        plain = name.removeprefix(ERROR_PREFIX)
        if plain not in QUANTITIES:
            choices = {*QUANTITIES, *experiment.controls, *experiment.follows, *experiment.settings._fields}
            raise table.fault(f"unknown column '{name}'; {nearest_name(plain, choices)}")
        if plain not in measured:
            raise table.fault(f"column '{name}' without a column '{plain}'")
        _check_unit(table, name, QUANTITIES[plain].unit)
    if not measured:
        raise table.fault(f"nothing measured: no column among {', '.join(QUANTITIES)}")
    return tuple(_measured_column(table, name, rows) for name in measured)


def _measured_column(table: _Table, name: str, rows: list[tuple[int, Cells]]) -> Measured:
    values = _column(table, name, rows)
    if ERROR_PREFIX + name not in table.names:
        return Measured(name, values, None)
    errors = _column(table, ERROR_PREFIX + name, rows)
    wrong = np.isfinite(values) & ~(errors > 0.0)
    if np.any(wrong):
        raise table.fault(f"{ERROR_PREFIX}{name} must be a number above 0", rows[int(np.argmax(wrong))][0])
    return Measured(name, values, errors)


def _check_unit(table: _Table, name: str, unit: str) -> None:
    stated = table.units[name]
    if stated != unit and not (stated is None and unit == "1"):
        given = "no unit" if stated is None else f"the unit [{stated}]"
        raise table.fault(f"column '{name}' has {given}; allowed: [{unit}]")


def _filled_column(table: _Table, name: str, rows: list[tuple[int, Cells]]) -> Array:
    values = _column(table, name, rows)
    if np.any(np.isnan(values)):
        raise table.fault(f"empty cell in {name}", rows[int(np.argmax(np.isnan(values)))][0])
    return values


def _column(table: _Table, name: str, rows: Iterable[tuple[int, Cells]]) -> Array:
    return np.array([_number(table, cells[name], line) for line, cells in rows])


def _number(table: _Table, text: str, line: int) -> float:
    if not text:
        return math.nan
    try:
        value = float(text)
    except ValueError:
        raise table.fault(f"'{text}' is not a number", line) from None
    if not math.isfinite(value):
        raise table.fault(f"'{text}' is not finite; leave a cell empty where nothing was measured", line)
    return value
