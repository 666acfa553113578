"""The figures of a sweep: each result over each key, and how the variance divides among the keys."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from grainlaw.mpm_core.output.picture_style import quantity_label
from grainlaw.studies.sensitivity import Indices, main_effect
from grainlaw.validation.report.plots import data_uri

PER_ROW, WIDTH, HEIGHT = 3, 2.9, 2.6
RUNS_COLOR, MEAN_COLOR, FIRST_COLOR, TOTAL_COLOR = "#7570b3", "#d95f02", "#1b9e77", "#d95f02"


def effects_image(keys: dict[str, Sequence[Any]], result: NDArray[np.float64], label: str, with_means: bool) -> str:
    """One result over each key: the runs as dots, and where asked the means over all other keys as a line."""
    figure, all_axes = _panels(len(keys))
    for axes, (key, values) in zip(all_axes, keys.items(), strict=True):
        axes.plot(values, result, "o", color=RUNS_COLOR, ms=3.5, alpha=0.6, mec="none", label="runs")
        if with_means:
            effect = main_effect(values, result)
            axes.plot(effect.values, effect.mean, "-", color=MEAN_COLOR, lw=1.4, marker="s", ms=4, label="mean")
        axes.set_xlabel(_short(key), fontsize=8)
    all_axes[0].set_ylabel(label, fontsize=8)
    if with_means:
        all_axes[0].legend(frameon=False, fontsize=7)
    return data_uri(figure)


def indices_image(keys: Sequence[str], found: Indices) -> str:
    """First-order and total indices of each key as bars, with their intervals where they have one."""
    figure = Figure(figsize=(max(3.4, 1.3 + 1.1 * len(keys)), 2.6), layout="constrained")
    axes = figure.add_subplot()
    _style(axes)
    places = np.arange(len(keys))
    for shift, values, interval, color, label in (
        (-0.18, found.first, found.first_interval, FIRST_COLOR, "first order"),
        (0.18, found.total, found.total_interval, TOTAL_COLOR, "total"),
    ):
        errors = interval if np.isfinite(interval).all() else None
        axes.bar(places + shift, values, 0.34, yerr=errors, color=color, label=label, capsize=3, error_kw={"lw": 1.0})
    axes.set_xticks(places, [_short(key) for key in keys], fontsize=8)
    axes.set_ylabel("share of the variance", fontsize=8)
    axes.legend(frameon=False, fontsize=7)
    return data_uri(figure)


def label_of(name: str, unit: str) -> str:
    """A result in words with its unit."""
    return quantity_label(name.replace("center", "centre"), unit)


def _panels(count: int) -> tuple[Figure, list[Axes]]:
    rows = -(-count // PER_ROW)
    columns = -(-count // rows)
    figure = Figure(figsize=(WIDTH * columns + 0.4, HEIGHT * rows), layout="constrained")
    panels = list(figure.subplots(rows, columns, squeeze=False, sharey=True).flat)
    for axes in panels[count:]:
        axes.set_visible(False)
    for axes in panels[:count]:
        _style(axes)
    return figure, panels[:count]


def _style(axes: Axes) -> None:
    axes.tick_params(labelsize=7)
    axes.grid(visible=True, color="#dddddd", lw=0.5)
    axes.set_axisbelow(True)


def _short(key: str) -> str:
    """A dotted key on two lines, so that it fits below its panel."""
    head, _, last = key.rpartition(".")
    return f"{head}.\n{last}" if head else last
