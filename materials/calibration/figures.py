"""The picture of a calibration: data and law above, weighted residuals below, one column per measured quantity."""

import textwrap
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from grainlaw.materials.atomic import replacing
from grainlaw.materials.calibration.data import DataSet, Measured
from grainlaw.materials.calibration.findings import Findings
from grainlaw.materials.calibration.model import ForwardModel, answer, weight
from grainlaw.materials.calibration.quantities import QUANTITIES

DATA_COLOUR, LAW_COLOUR = "#333333", "#d95f02"
POINTS_BETWEEN_ROWS = 6
LETTERS_PER_PANEL = 52

Array = NDArray[np.float64]


def draw(findings: Findings, model: ForwardModel, path: Path) -> None:
    """Write the picture, whole or not at all; `model` is that of the fit."""
    panels = [(data, measured) for data in model.data for measured in data.measured]
    with mpl.rc_context({"font.size": 9, "axes.grid": True, "grid.color": "#dddddd", "grid.linewidth": 0.5}):
        figure = Figure(figsize=(max(4.6, 4.2 * len(panels)), 5.0), layout="constrained")
        axes = figure.subplots(2, len(panels), squeeze=False, sharex="col", height_ratios=(3, 1))
        for (data, measured), (upper, lower) in zip(panels, axes.T, strict=True):
            _draw_fit(findings, model, data, measured, upper)
            _draw_residuals(findings, model, data, measured, lower)
        axes[0, 0].legend(loc="lower right", framealpha=0.8, edgecolor="none")
        title = f"{findings.fit.law.name}: " + ", ".join(_estimates(findings))
        figure.suptitle(textwrap.fill(title, LETTERS_PER_PANEL * len(panels)), fontsize=10)
        with replacing(path) as partial:
            figure.savefig(partial, dpi=130)


def _estimates(findings: Findings) -> list[str]:
    return [
        f"{found.name}\u00a0=\u00a0{found.value:.3g}{'' if found.determined else ' (undetermined)'}"
        for found in findings.estimates
    ]


def _draw_fit(findings: Findings, model: ForwardModel, data: DataSet, measured: Measured, axes: Axes) -> None:
    fit = findings.fit
    errors = None if measured.standard_errors is None else findings.quantile * measured.standard_errors
    axes.errorbar(
        data.abscissa,
        measured.values,
        errors,
        fmt="o",
        ms=4,
        lw=1,
        color=DATA_COLOUR,
        label="data, 95 %" if errors is not None else "data",
    )
    at_fixed_numbers = data.experiment.name == "steady-shear"
    between = _between_rows(data.abscissa if at_fixed_numbers else np.concatenate([[0.0], data.abscissa]))
    curve = answer(model.history(data, fit.values, between), measured)
    axes.plot(between, curve, color=LAW_COLOUR, lw=1.5, label=fit.law.name)
    axes.set_title(data.label, fontsize=9)
    axes.set_ylabel(_label(measured.name, QUANTITIES[measured.name].unit))
    if at_fixed_numbers:
        axes.set_xscale("log")


def _draw_residuals(findings: Findings, model: ForwardModel, data: DataSet, measured: Measured, axes: Axes) -> None:
    fit = findings.fit
    residuals = (measured.values - answer(model.history(data, fit.values, data.abscissa), measured)) / weight(measured)
    axes.axhline(0.0, color=LAW_COLOUR, lw=1.0)
    axes.plot(data.abscissa, residuals, "o", ms=4, color=DATA_COLOUR)
    axes.set_ylabel("(data - law)/\n" + ("standard error" if fit.knows_errors else "size of the data"))
    axes.set_xlabel(_label(data.control, data.experiment.controls[data.control].unit))


def _between_rows(abscissa: Array) -> Array:
    """The rows and evenly spaced values between them, in the order of the path."""
    rows = np.arange(abscissa.size)
    return np.interp(np.linspace(0.0, rows[-1], POINTS_BETWEEN_ROWS * max(1, rows[-1]) + 1), rows, abscissa)


def _label(name: str, unit: str) -> str:
    return f"{name.replace('_', ' ')} [{unit}]"
