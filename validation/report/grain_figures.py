"""The figures of the report: the grains as a grey band of all their runs, each law as a coloured line."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from grainlaw.validation.dem.judging.data_table import friction_of_mean_pressure
from grainlaw.validation.dem.judging.judgement import Judgement
from grainlaw.validation.grains.distance import surface_at
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.reference.reference_set import Ensemble, Rows
from grainlaw.validation.report.plots import data_uri

COLORS = ("#d95f02", "#1b9e77", "#7570b3", "#e7298a", "#66a61e", "#e6ab02", "#a6761d", "#1f78b4", "#b2182b")
BAND, MEAN = "#cccccc", "#555555"
WIDTH = 7.2
SHARES_OF_RUNOUT = (0.1, 0.25, 0.5, 0.75, 0.95)
SERIES = (
    ("runout", "runout $w$"),
    ("height", "height $H$"),
    ("kinetic_energy", "kinetic energy"),
    ("interior_solid_fraction", r"interior $\phi$"),
)
STRESSES = (("stress_zz", r"$\sigma_{zz}$ [Pa]"), ("stress_xx", r"$\sigma_{xx}$ [Pa]"))


def profile_figure(ensemble: Ensemble, judgements: Sequence[Judgement]) -> str:
    """Surfaces at shares of the runout of the grains and at rest."""
    times = _times(ensemble)
    x = max((run.x for run in ensemble.runs), key=len)
    rows, columns = (3, 2) if len(times) > 1 else (1, 1)
    figure = Figure(figsize=(WIDTH, 0.8 + 1.55 * rows + 1.0 / rows), layout="constrained")
    all_axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes, time in zip(all_axes.flat, times, strict=True):
        surfaces = np.array([surface_at(run, time, x) for run in ensemble.runs])
        _grains(axes, x, surfaces)
        for color, judged, observation in _observed(judgements):
            axes.plot(x, surface_at(observation, time, x), color=color, lw=1.1, label=judged.name)
        axes.set_title(f"t = {time:.2f} s" + (", at rest" if time == times[-1] else ""), fontsize=9)
        _style(axes)
    reach = 1.15 * max(float(run.of("runout")[-1]) for run in ensemble.runs)
    is_round = ensemble.space.hoop
    all_axes[0, 0].set_xlim(0.0 if is_round else -reach, reach)
    for axes in all_axes[-1]:
        axes.set_xlabel("r [m]" if is_round else "x [m]", fontsize=9)
    for axes in all_axes[:, 0]:
        axes.set_ylabel("h [m]", fontsize=9)
    _legend(figure, all_axes[0, 0])
    return data_uri(figure)


def series_figure(ensemble: Ensemble, judgements: Sequence[Judgement]) -> str:
    """Runout, height, kinetic energy and interior solid fraction over time."""
    figure = Figure(figsize=(WIDTH, 4.8), layout="constrained")
    all_axes = figure.subplots(2, 2, sharex=True)
    times = ensemble.runs[0].times
    times = times[times <= ensemble.end]
    for axes, (name, label) in zip(all_axes.flat, SERIES, strict=True):
        values = np.array([np.interp(times, run.times, run.of(name)) for run in ensemble.runs if name in run.series])
        if len(values):
            _grains(axes, times, values)
        for color, judged, observation in _observed(judgements):
            if name in observation.series:
                axes.plot(observation.times, observation.of(name), color=color, lw=1.1, label=judged.name)
        axes.set_ylabel(f"{label} [{ensemble.runs[0].unit_of(name)}]", fontsize=9)
        _style(axes)
    for axes in all_axes[-1]:
        axes.set_xlabel("t [s]", fontsize=9)
    _legend(figure, all_axes[0, 0])
    return data_uri(figure)


def distance_figure(judgements: Sequence[Judgement], band: float) -> str:
    """E_A over time on one column, with the two bands."""
    figure = Figure(figsize=(WIDTH, 2.9), layout="constrained")
    axes = figure.subplots()
    axes.axhspan(0.0, band, color="#d9f0d3", lw=0)
    axes.axhspan(band, 2.0 * band, color="#fff2cc", lw=0)
    for number, judged in enumerate(judgements):
        if judged.comparison is not None:
            found, color = judged.comparison, COLORS[number % len(COLORS)]
            axes.plot(found.times, found.profiles, color=color, lw=1.1, label=judged.name)
            axes.fill_between(found.times, found.nearest, found.farthest, color=color, alpha=0.15, lw=0)
    axes.set_xlabel("t [s]", fontsize=9)
    axes.set_ylabel("$E_A$", fontsize=9)
    axes.set_ylim(bottom=0.0)
    _style(axes)
    _legend(figure, axes)
    return data_uri(figure)


def stress_figure(ensemble: Ensemble, judgements: Sequence[Judgement]) -> str:
    """Vertical and horizontal stress over the height along the axis: at the release, halfway, at rest."""
    told = [run for run in ensemble.runs if "stress_zz" in run.snapshots]
    columns = min(len(run.snapshot_times) for run in told)
    figure = Figure(figsize=(WIDTH, 4.6), layout="constrained")
    all_axes = figure.subplots(2, columns, sharey=True, squeeze=False)
    for row, (name, label) in zip(all_axes, STRESSES, strict=True):
        for number, axes in enumerate(row):
            for count, run in enumerate(told):
                profile = along_axis(run, name, number)
                axes.plot(profile, run.z, color=MEAN, lw=1.0, alpha=0.6, label="grains" if count == 0 else None)
            for color, judged, observation in _observed(judgements):
                if name in observation.snapshots and number < len(observation.snapshot_times):
                    profile = along_axis(observation, name, number)
                    axes.plot(profile, observation.z, color=color, lw=1.0, label=judged.name)
            axes.set_xlabel(label, fontsize=9)
            _style(axes)
    for axes, name in zip(all_axes[0], ("at the release", "halfway", "at rest"), strict=False):
        axes.set_title(name, fontsize=9)
    for axes in all_axes[:, 0]:
        axes.set_ylabel("z [m]", fontsize=9)
        axes.set_ylim(0.0, 1.2 * max(float(run.of("height")[0]) for run in told))
    _legend(figure, all_axes[0, 0])
    return data_uri(figure)


def along_axis(observation: Observation, name: str, number: int) -> np.ndarray:
    """A field of one snapshot, the mean over a third of the half width on both sides of the axis; shape (z,)."""
    half_width = observation.of("runout")[0]
    return np.asarray(observation.snapshots[name][number][np.abs(observation.x) < half_width / 3.0].mean(axis=0))


def shear_figure(shear: Rows, curves: dict[str, tuple[Sequence[float], Sequence[float]]]) -> str:
    """Friction and solid fraction of the grains over the inertial number, with the friction of the fitted laws."""
    figure = Figure(figsize=(WIDTH, 3.0), layout="constrained")
    friction, fraction = figure.subplots(1, 2)
    numbers = [row["I"] for row in shear]
    ratios, errors = zip(*(friction_of_mean_pressure(row) for row in shear), strict=True)
    friction.errorbar(numbers, ratios, errors, fmt="o", ms=3, color=MEAN, label="grains")
    friction.plot(numbers, [row["mu"] for row in shear], "x", ms=4, color="#999999", label="over the normal stress")
    for number, (name, (x, y)) in enumerate(curves.items()):
        friction.plot(x, y, color=COLORS[number % len(COLORS)], lw=1.1, label=name)
    fraction.plot(numbers, [row["phi"] for row in shear], "o", ms=3, color=MEAN)
    for axes, label in ((friction, r"$\tau/p$"), (fraction, r"$\phi$")):
        axes.set_xscale("log")
        axes.set_xlabel("I, engineering rate", fontsize=9)
        axes.set_ylabel(label, fontsize=9)
        _style(axes)
    friction.legend(frameon=False, fontsize=7)
    return data_uri(figure)


def _times(ensemble: Ensemble) -> list[float]:
    """When the mean runout of the grains has grown by given shares, and the end [s]."""
    times = ensemble.runs[0].times
    times = times[times <= ensemble.end]
    if len(times) < 2:
        return [ensemble.end]
    runout = np.mean([np.interp(times, run.times, run.of("runout")) for run in ensemble.runs], axis=0)
    growth = np.maximum.accumulate((runout - runout[0]) / (runout[-1] - runout[0]))
    return [float(np.interp(share, growth, times)) for share in SHARES_OF_RUNOUT] + [ensemble.end]


def _grains(axes: Axes, x: np.ndarray, values: np.ndarray) -> None:
    """Their runs, shape (run, x), as a band with its mean."""
    axes.fill_between(x, values.min(axis=0), values.max(axis=0), color=BAND, lw=0, label="grains, all runs")
    axes.plot(x, values.mean(axis=0), color=MEAN, lw=1.0, label="grains, mean")


def _observed(judgements: Sequence[Judgement]) -> list[tuple[str, Judgement, Observation]]:
    return [
        (COLORS[number % len(COLORS)], judged, judged.observation)
        for number, judged in enumerate(judgements)
        if judged.observation is not None
    ]


def _style(axes: Axes) -> None:
    axes.tick_params(labelsize=8)
    axes.grid(visible=True, color="#e5e5e5", lw=0.5)


def _legend(figure: Figure, axes: Axes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False, fontsize=8)
