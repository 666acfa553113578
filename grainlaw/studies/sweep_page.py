"""The page of a sweep, `sweep.html`: what failed, each result over each key, how much each key matters, all runs."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from grainlaw.studies.design import Design
from grainlaw.studies.sensitivity import indices, rank_correlation, results_of
from grainlaw.studies.sweep_plots import effects_image, indices_image, label_of
from grainlaw.studies.table import FAILED, RESULTS, units
from grainlaw.validation.report.page import Page, Picture, Section
from grainlaw.validation.report.page import Table as Rows

PAGE_NAME = "sweep.html"
KINDS = {
    "grid": "all combinations of the values",
    "hypercube": "a Latin hypercube: each n-th part of a range holds one run",
    "sobol": "Saltelli's design for Sobol indices",
    "draws": "draws from what a calibration left open",
}
EXACT = (
    "Shares of the variance over the grid: first order is what the mean over all other keys does, total what is left "
    "of it when all others are known. They are those of this grid, without error."
)
SAMPLED = (
    "Shares of the variance: first order is what a key does alone, total what it does together with others as well; "
    "with 95 % intervals from {runs} runs."
)


def page_of(design: Design, table: pa.Table, title: str, command: str) -> Page:
    """The page of a sweep from its table."""
    failed = table["verdict"].to_pylist().count(FAILED)
    finished = len(table) - failed
    introduction = (
        f"{len(table)} runs, {finished} finished, {failed} failed; {KINDS[design.kind]}, over "
        f"{', '.join(design.keys)}. sweep.csv and sweep.parquet beside this page hold the table at its end; each run "
        "has a folder of its name.",
    )
    sections = [*_failures(design, table), *_results(design, table), _runs(design, table)]
    return Page(f"Sweep: {title}", introduction, tuple(sections), command)


def _failures(design: Design, table: pa.Table) -> Iterator[Section]:
    rows = [row for row in table.to_pylist() if row["verdict"] == FAILED]
    if rows:
        cells = tuple(
            (row["run"], row["reason"], ", ".join(f"{key} = {_cell(row[key])}" for key in design.keys)) for row in rows
        )
        yield Section("Failed runs", tables=(Rows("Failed runs", "", ("run", "reason", "values"), cells),))


def _results(design: Design, table: pa.Table) -> Iterator[Section]:
    known = units(table)
    keys = {key: table[key].to_pylist() for key in design.keys}
    for name, result in results_of(table, [quantity.name for quantity in RESULTS]).items():
        label = label_of(name, known.get(name, ""))
        on_grid = design.kind == "grid"
        image = effects_image(keys, result, label, on_grid)
        what = "runs, and their means over all other keys" if on_grid else "runs"
        yield _section(design, result, label, Picture(image, f"{label} over each key: {what}."))


def _section(design: Design, result: NDArray[np.float64], label: str, effects: Picture) -> Section:
    found = indices(design, result)
    ranks = [rank_correlation([row[n] for row in design.rows], result) for n in range(len(design.keys))]
    columns: tuple[str, ...] = ("key", "rank correlation")
    rows: list[tuple[str, ...]] = [
        (key, "-" if np.isnan(rank) else f"{rank:.2f}") for key, rank in zip(design.keys, ranks, strict=True)
    ]
    if found is None:
        return Section(label, tables=(Rows(label, "", columns, tuple(rows)),), figures=(effects,))
    columns += ("first order", "total")
    first = _with_intervals(found.first, found.first_interval)
    total = _with_intervals(found.total, found.total_interval)
    rows = [(*row, *shares) for row, *shares in zip(rows, first, total, strict=True)]
    note = EXACT if np.isnan(found.first_interval).all() else SAMPLED.format(runs=found.runs)
    shares_image = Picture(indices_image(design.keys, found), f"{label}: shares of the variance.")
    return Section(label, tables=(Rows(label, note, columns, tuple(rows)),), figures=(effects, shares_image))


def _with_intervals(values: NDArray[np.float64], half_widths: NDArray[np.float64]) -> list[str]:
    return [
        f"{value:.2f}" if np.isnan(half) else f"{value:.2f} ± {half:.2f}"
        for value, half in zip(values, half_widths, strict=True)
    ]


def _runs(design: Design, table: pa.Table) -> Section:
    known = units(table)
    names = ["run", *design.keys, "verdict", *(quantity.name for quantity in RESULTS), "wall_time"]
    heads = tuple(label_of(name, known[name]) if name in known else name for name in names)
    rows = tuple(tuple(_cell(row[name]) for name in names) for row in table.to_pylist())
    return Section("All runs", tables=(Rows("All runs", "", heads, rows),))


def _cell(value: Any) -> str:
    if value is None or (isinstance(value, float) and np.isnan(value)):
        return "-"
    return f"{value:.5g}" if isinstance(value, float) else str(value)
