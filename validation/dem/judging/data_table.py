"""A data file for `grainlaw calibrate` as text, and means over packings of grains."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from grainlaw.validation.reference.reference_set import Rows

Array = NDArray[np.float64]
FRICTION = ("friction_of_mean_pressure [1]", "standard_error_friction_of_mean_pressure [1]")
FRACTION = ("solid_fraction [1]", "standard_error_solid_fraction [1]")
NUMBER, STRAIN, TIME = "engineering_inertial_number [1]", "engineering_shear_strain [1]", "time [s]"


def data_table(statements: dict[str, str], names: Sequence[str], rows: Sequence[tuple[float, ...]]) -> str:
    """Statements, a header and rows; NaN leaves a cell empty."""
    lines = [f"# {name} = {value}" for name, value in statements.items()]
    lines += [",".join(names), *(",".join(_cell(value) for value in row) for row in rows)]
    return "\n".join(lines) + "\n"


def _cell(value: float) -> str:
    """A number, or nothing where nothing was measured."""
    return "" if math.isnan(value) else f"{value:.6g}"


def by_seed(rows: Rows) -> list[Rows]:
    """The rows of each packing."""
    return [[row for row in rows if row["seed"] == seed] for seed in sorted({row["seed"] for row in rows})]


def friction_of_mean_pressure(row: dict[str, float]) -> tuple[float, float]:
    """tau/p of a row of steady shear, and its standard error."""
    friction = row["tau_over_p3"]
    return friction, row["se_mu"] * friction / row["mu"]


def mean_and_error(values: Array) -> tuple[Array, Array]:
    """Mean over packings of values (packings, rows) and its standard error, each (rows,).

    Three packings and more tell the error row by row, two one error for all rows, and one by the scatter of its
    neighbouring rows.
    """
    packings, rows = values.shape
    if packings > 2:
        errors = values.std(axis=0, ddof=1)
    elif packings == 2:
        errors = np.full(rows, np.sqrt(np.mean(values.var(axis=0, ddof=1))))
    else:
        errors = np.full(rows, np.sqrt(0.5 * np.mean(np.diff(values[0]) ** 2)))
    return values.mean(axis=0), errors / np.sqrt(packings)
