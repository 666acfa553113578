"""The figures of a prediction: bands of profile, runout and height, with the grains as lines."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from grainlaw.studies.bands import Array, Band
from grainlaw.studies.predict import Prediction
from grainlaw.validation.grains.distance import surface_at
from grainlaw.validation.report.plots import data_uri

WIDE, NARROW, GRAINS = "#fdd0a2", "#fd8d3c", "#333333"
CELL, STEP, PLACE, DRAWS = "#1b9e77", "#7570b3", "#e7298a", "#d95f02"
# Beyond the outermost end of the band.
MARGIN = 1.1


def profile_figure(prediction: Prediction) -> str:
    """The surface at the end above, standard deviations by what they come from below."""
    figure = Figure(figsize=(7.2, 5.4), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    x, profile = prediction.x, prediction.profile
    _draw_band(above, x, profile)
    for number, found in enumerate(prediction.grains):
        surface = surface_at(found, prediction.times[-1], x)
        above.plot(x, surface, color=GRAINS, lw=0.9, alpha=0.8, label=None if number else "grains")
    above.set_ylabel("h [m]", fontsize=9)
    above.set_title(f"profile at t = {prediction.times[-1]:g} s", fontsize=10)
    for label, variance, color in (
        ("parameters", profile.parameters, DRAWS),
        ("half the cell", profile.numerics.cell, CELL),
        ("half the step", profile.numerics.step, STEP),
        ("places of points", profile.numerics.place, PLACE),
    ):
        below.plot(x, np.sqrt(variance), color=color, lw=1.1, label=label)
    below.set_ylabel("standard deviation [m]", fontsize=9)
    below.set_xlabel("r [m]" if prediction.is_round else "x [m]", fontsize=9)
    ends = x[profile.upper > prediction.width]
    reach = MARGIN * float(np.abs(ends).max()) if len(ends) else float(np.abs(x).max())
    above.set_xlim(0.0 if prediction.is_round else -reach, reach)
    for axes in (above, below):
        axes.set_ylim(bottom=0.0)
        _finish(axes)
    return data_uri(figure)


def series_figure(prediction: Prediction) -> str:
    """Runout and height over time."""
    figure = Figure(figsize=(7.2, 3.2), layout="constrained")
    for axes, (name, found) in zip(figure.subplots(1, 2), prediction.series.items(), strict=True):
        _draw_band(axes, prediction.times, found)
        for number, grains in enumerate(prediction.grains):
            label = None if number else "grains"
            marker = "o" if len(grains.times) == 1 else ""
            axes.plot(grains.times, grains.of(name), color=GRAINS, lw=0.9, alpha=0.8, marker=marker, label=label)
        axes.set_xlim(0.0, prediction.times[-1])
        axes.set_ylabel(f"{name} [m]", fontsize=9)
        axes.set_xlabel("t [s]", fontsize=9)
        _finish(axes)
    return data_uri(figure)


def _draw_band(axes: Axes, x: Array, found: Band) -> None:
    axes.fill_between(x, found.lower, found.upper, color=WIDE, lw=0, label="5 to 95 %, with numerics")
    axes.fill_between(x, found.drawn_lower, found.drawn_upper, color=NARROW, lw=0, label="5 to 95 % of the draws")
    axes.plot(x, found.median, color=DRAWS, lw=1.0, label="median")


def _finish(axes: Axes) -> None:
    axes.tick_params(labelsize=8)
    axes.grid(visible=True, color="#e5e5e5", lw=0.5)
    axes.legend(frameon=False, fontsize=7)
