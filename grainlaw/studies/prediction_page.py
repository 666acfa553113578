"""The page and the files of a prediction."""

import csv
import io
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from grainlaw.studies.bands import Array, Band
from grainlaw.studies.predict import Prediction
from grainlaw.studies.prediction_figures import profile_figure, series_figure
from grainlaw.validation.report.page import OUTSIDE, SECTIONS, WITHIN, Page, Picture, Section, Table
from grainlaw.validation.report.write import as_json, write_texts

PAGE, RESULT, PROFILE, SERIES = "prediction.html", "prediction.json", "profile.csv", "series.csv"
COLUMNS = ("median", "lower", "upper", "lower_of_draws", "upper_of_draws", "share_of_parameters")
FORMULA = (
    "Orange: 5 to 95 % of the draws. Light: with the numerical spread, whose variance is (q - q of half the cell)^2 + "
    "(q - q of half the step)^2 + the variance over four places of the points within their cells, all at the estimate "
    "of the parameters. The light band reaches sqrt(a^2 + (1.645 s)^2) from the median, where that of the draws "
    "reaches a and s is the numerical standard deviation.",
    "The bands hold what the calibration left open and what the computation owes to its resolution. They do not hold "
    "what the law itself leaves out, nor an error of density, geometry or floor.",
)


def write_prediction(prediction: Prediction, folder: Path, command: str) -> list[Path]:
    """Write page, JSON and tables into a folder; returns their paths."""
    page = Page(
        f"Prediction: {prediction.scene.title or prediction.scene.source}",
        _introduction(prediction),
        (_parameters(prediction), _bands(prediction), *_comparison(prediction)),
        command,
    )
    texts = {
        PAGE: page.html(),
        RESULT: as_json(_content(prediction, command)),
        PROFILE: _table("x", prediction.x, {"": prediction.profile}),
        SERIES: _table("t", prediction.times, {f"{name}_": found for name, found in prediction.series.items()}),
        SECTIONS: page.json(),
    }
    return write_texts(folder, texts)


def notes(prediction: Prediction) -> tuple[str, ...]:
    """What a reader has to know before using the bands."""
    table, draws = prediction.calibrated.table, prediction.draws
    found = [
        f"the data did not determine {name}: it is held at {prediction.calibrated.values[name]:g}, and the bands do "
        "not hold what it leaves open"
        for name in table.held
    ]
    found += [f"of the calibration: {remark}" for remark in table.remarks]
    if draws.refused:
        found.append(f"{draws.refused} draws beyond what the law allows were drawn again")
    found += [
        f"{name} is {value:g} in the calibration, which holds here, and {given:g} in the scene"
        for name, (given, value) in prediction.replaced.items()
    ]
    found += [f"{outcome.name} failed and is left out: {outcome.reason}" for outcome in prediction.failed]
    if prediction.scene.in_space.hoop:
        found.append("around an axis the places of points are not varied: numerics are cells and steps alone")
    return tuple(found)


def result_table(prediction: Prediction) -> Table:
    """Runout and height at the end."""
    rows = [_result_row(name, found, -1) for name, found in prediction.series.items()]
    profile = prediction.profile
    thick = profile.median > prediction.width
    if thick.any():
        rows.append(_result_row("profile, where it is thickest", profile, int(np.argmax(profile.median))))
        rows.append(_result_row("profile, where it is least certain", profile, int(np.argmax(_deviation(profile)))))
    columns = ("quantity", "median [m]", "5 to 95 % [m]", "of draws alone [m]", "standard deviation: parameters [m]",
               "cell [m]", "step [m]", "places [m]", "share of parameters")  # fmt: skip
    note = f"At t = {prediction.times[-1]:g} s, from {prediction.finished_draws} draws."
    return Table("Bands", note, columns, tuple(rows))


def grains_table(prediction: Prediction) -> Table:
    """Whether the bands hold the grains."""
    rows = []
    for found in prediction.grains:
        share = prediction.profile_within(found)
        held = [
            (WITHIN if lower <= value <= upper else OUTSIDE, value)
            for value, lower, upper in (
                (float(np.interp(prediction.times[-1], found.times, found.of(name))), band.lower[-1], band.upper[-1])
                for name, band in prediction.series.items()
            )
        ]
        cells = [cell for verdict, value in held for cell in (f"{value:.4g}", verdict)]
        rows.append((found.label, f"{100.0 * share:.0f} %", *cells))
    columns = ["grains", "share of the profile within the band"]
    for name in prediction.series:
        columns += [f"{name} [m]", ""]
    note = (
        f"At t = {prediction.times[-1]:g} s, where band or grains stand higher than {prediction.width:g} m, the "
        "width of the kernel with which both are observed."
    )
    return Table("Do the bands hold the grains?", note, tuple(columns), tuple(rows))


def _introduction(prediction: Prediction) -> tuple[str, ...]:
    table = prediction.calibrated.table
    cell = prediction.scene.grid.cell_size
    return (
        f"grainlaw {version('grainlaw')}: {prediction.scene.source} with {table.law}, cells of {cell * 1e3:g} mm; "
        f"{len(prediction.draws.values)} draws of {', '.join(table.drawn)} (seed {prediction.seed}) from what "
        f"{', '.join(table.sources)} left open.",
        *(f"Note: {note}." for note in notes(prediction)),
    )


def _parameters(prediction: Prediction) -> Section:
    table, law = prediction.calibrated.table, prediction.calibrated.law
    rows = []
    for name in table.drawn:
        values = [values[name] for values in prediction.draws.values]
        low, high = np.quantile(values, (0.05, 0.95), method="weibull")
        unit = law.parameter_declarations[name].unit
        rows.append((name, unit, f"{prediction.calibrated.values[name]:.5g}", f"{low:.5g} to {high:.5g}"))
    rows += [
        (
            name,
            law.parameter_declarations[name].unit,
            f"{value:.5g}",
            "held: not determined" if name in table.held else "",
        )
        for name, value in prediction.calibrated.values.items()
        if name not in table.drawn
    ]
    columns = ("parameter", "unit", "value", "5 to 95 % of the draws")
    return Section("Parameters", tables=(Table("Parameters", f"Law {table.law}.", columns, tuple(rows)),))


def _bands(prediction: Prediction) -> Section:
    figures = (
        Picture(profile_figure(prediction), "Surface at the end; below, what its uncertainty comes from."),
        Picture(series_figure(prediction), "Runout and height over time."),
    )
    return Section("Profile, runout and height", FORMULA, (result_table(prediction),), figures)


def _comparison(prediction: Prediction) -> tuple[Section, ...]:
    if not prediction.grains:
        return ()
    return (Section("Against grains", tables=(grains_table(prediction),)),)


def _deviation(found: Band) -> Array:
    return np.asarray(np.sqrt(found.parameters + found.numerics.variance))


def _result_row(name: str, found: Band, at: int) -> tuple[str, ...]:
    parts = (found.parameters, found.numerics.cell, found.numerics.step, found.numerics.place)
    share = found.share_of_parameters[at]
    return (
        name,
        f"{found.median[at]:.4g}",
        f"{found.lower[at]:.4g} to {found.upper[at]:.4g}",
        f"{found.drawn_lower[at]:.4g} to {found.drawn_upper[at]:.4g}",
        *(f"{np.sqrt(part[at]):.2g}" for part in parts),
        "" if np.isnan(share) else f"{100.0 * share:.0f} %",
    )


def _columns(found: Band) -> tuple[Array, ...]:
    return (found.median, found.lower, found.upper, found.drawn_lower, found.drawn_upper, found.share_of_parameters)


def _table(name: str, abscissa: Array, bands: dict[str, Band]) -> str:
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow([name, *(f"{prefix}{column}" for prefix in bands for column in COLUMNS)])
    columns = [abscissa, *(column for found in bands.values() for column in _columns(found))]
    rows.writerows([[f"{value:.8g}" for value in row] for row in np.column_stack(columns).tolist()])
    return text.getvalue()


def _content(prediction: Prediction, command: str) -> dict[str, Any]:
    table = prediction.calibrated.table
    return {
        "version": version("grainlaw"),
        "command": command,
        "scene": prediction.scene.source,
        "law": table.law,
        "drawn": table.drawn,
        "held": table.held,
        "samples": len(prediction.draws.values),
        "finished_draws": prediction.finished_draws,
        "refused_draws": prediction.draws.refused,
        "seed": prediction.seed,
        "cell_size": prediction.scene.grid.cell_size,
        "kernel_width": prediction.width,
        "time": float(prediction.times[-1]),
        "draws": list(prediction.draws.values),
        "at_end": {name: _numbers(found) for name, found in prediction.series.items()},
        "grains": [
            {"name": found.label, "share_of_profile_within_band": prediction.profile_within(found)}
            for found in prediction.grains
        ],
        "failed": {outcome.name: outcome.reason for outcome in prediction.failed},
        "notes": list(notes(prediction)),
    }


def _numbers(found: Band) -> dict[str, float]:
    values = {name: float(column[-1]) for name, column in zip(COLUMNS, _columns(found), strict=True)}
    parts = {"parameters": found.parameters, "cell": found.numerics.cell, "step": found.numerics.step,
             "place": found.numerics.place}  # fmt: skip
    return values | {f"variance_of_{name}": float(part[-1]) for name, part in parts.items()}
