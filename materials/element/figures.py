"""Pictures of element tests: four panels, several materials in one picture."""

from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, MaxNLocator, NullFormatter, ScalarFormatter
from numpy.typing import NDArray
from PIL import Image

from grainlaw.materials.element.lines import compression_lines, critical_stress_ratio
from grainlaw.materials.element.result import ElementResult
from grainlaw.materials.element.shear import ConstantPressureShearSettings
from grainlaw.materials.tensor import SymmetricTensor

COLOURS = ("tab:green", "tab:blue", "tab:purple", "tab:orange", "tab:brown", "tab:pink", "tab:olive", "tab:cyan")
COLOURS_OF_A_PICTURE = 128
DASHES = ("solid", "dashed", "dotted", "dashdot")
SIZE = (16.0, 4.2)
"""Width and height of the figure [inch]."""
STYLE: Any = {"font.size": 11, "mathtext.fontset": "cm", "axes.grid": False}

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Curve:
    """A result and how it is drawn: one colour per law, one dash pattern per parameter set of it."""

    result: ElementResult
    colour: str
    dash: str

    def draw(self, axes: Axes, x: Array, y: Array) -> None:
        """The curve, with a dot where it starts and a star where it ends."""
        axes.plot(x, y, color=self.colour, linestyle=self.dash, linewidth=2.0, label=self.result.specimen.label)
        drawn = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
        for index, marker, size in ((drawn[:1], "o", 6), (drawn[-1:], "*", 11)):
            axes.plot(x[index], y[index], marker, color=self.colour, markersize=size, clip_on=False, zorder=3)


def draw(results: Sequence[ElementResult], path: Path) -> None:
    """Write the picture of one test on one or several materials: the paper's Figure 1 or its like for other tests."""
    figure = Figure(figsize=SIZE, layout="constrained")
    draw_on(figure, results)
    write(figure, path)


def draw_on(figure: Figure, results: Sequence[ElementResult]) -> None:
    """Draw the four panels of one test on one or several materials onto an empty figure."""
    curves = _curves(results)
    with mpl.rc_context(STYLE):
        panels = figure.subplots(1, 4)
        if isinstance(results[0].settings, ConstantPressureShearSettings):
            _draw_over_time(panels, curves, results[0].settings)
        else:
            _draw_over_strain(panels, curves)
        _draw_compression(panels[2], curves)
        _draw_stress_path(panels[3], curves)
        for letter, axes in zip("abcd", panels, strict=True):
            axes.set_title(f"({letter})", y=-0.32)
            axes.tick_params(direction="in", top=True, right=True, which="both")
        _draw_legend(figure, panels)


def write(figure: Figure, path: Path) -> None:
    """Write a PNG with a palette, a third of the size of one with all colours."""
    buffer = BytesIO()
    with mpl.rc_context(STYLE):
        figure.savefig(buffer, format="png", dpi=130)
    with Image.open(buffer) as image:
        image.convert("RGB").quantize(COLOURS_OF_A_PICTURE).save(path, optimize=True)


def _curves(results: Sequence[ElementResult]) -> list[Curve]:
    laws = list(dict.fromkeys(result.specimen.law.name for result in results))
    seen: list[str] = []
    curves = []
    for result in results:
        name = result.specimen.law.name
        curves.append(Curve(result, COLOURS[laws.index(name) % len(COLOURS)], DASHES[seen.count(name) % len(DASHES)]))
        seen.append(name)
    return curves


def _draw_over_time(
    panels: NDArray[np.object_], curves: Sequence[Curve], settings: ConstantPressureShearSettings
) -> None:
    """Stress ratio and apparent viscosity over time, with the stages of the inertial number."""
    stress_ratio, viscosity = panels[0], panels[1]
    for curve in curves:
        result = curve.result
        curve.draw(stress_ratio, result.time, result.deviatoric_stress / result.pressure)
        curve.draw(viscosity, result.time, result.viscosity)
    for ratio in _critical_ratios(curves):
        stress_ratio.axhline(ratio, color="red", linewidth=1.0, label="CSL")
    stress_ratio.set(xlabel="$t$ [s]", ylabel="$q/p$ [-]", ylim=(-0.1, None))
    viscosity.set(xlabel="$t$ [s]", ylabel=r"$\eta$ [Pa.s] (log scale)", yscale="log")
    lowest, highest = viscosity.get_ylim()
    if highest < 1.5 * lowest:
        # A constant: its rounding is not worth the panel.
        viscosity.set_ylim(0.1 * lowest, 10.0 * highest)
    ends = np.cumsum([settings.slow_duration, settings.ramp_duration, settings.fast_duration])
    for axes in (stress_ratio, viscosity):
        for number, (end, duration) in enumerate(zip(ends, np.diff(ends, prepend=0.0), strict=True), start=1):
            axes.axvline(end, color="black", linestyle="dashed", linewidth=1.0)
            axes.text(end - 0.5 * duration, 0.12, f"$I_{number}$", transform=axes.get_xaxis_transform(), ha="center")


def _draw_over_strain(panels: NDArray[np.object_], curves: Sequence[Curve]) -> None:
    """Stress ratio and volumetric strain over the component of strain that changes most."""
    largest = max((curve.result.strain for curve in curves), key=lambda strain: float(np.max(np.abs(strain))))
    component = int(np.argmax(np.max(np.abs(largest), axis=0)))
    label = rf"$|\varepsilon_{{{SymmetricTensor._fields[component]}}}|$ [-]"
    for curve in curves:
        result = curve.result
        strain = np.abs(result.strain[:, component])
        curve.draw(panels[0], strain, result.deviatoric_stress / result.pressure)
        curve.draw(panels[1], strain, result.log_specific_volume[0] - result.log_specific_volume)
    for ratio in _critical_ratios(curves):
        panels[0].axhline(ratio, color="red", linewidth=1.0, label="CSL")
    panels[0].set(xlabel=label, ylabel="$q/p$ [-]", ylim=(-0.1, None))
    panels[1].set(xlabel=label, ylabel=r"$\varepsilon_v$ [-]")


def _draw_compression(axes: Axes, curves: Sequence[Curve]) -> None:
    """Specific volume over pressure, both logarithmic, with the lines of the laws that have them."""
    pressures = np.concatenate([curve.result.pressure for curve in curves])
    pressures = pressures[pressures > 0.0]
    span = np.geomspace(0.5 * float(np.min(pressures)), 1.5 * float(np.max(pressures)), 50)
    axes.set(xscale="log", yscale="log", xlim=(span[0], span[-1]), xlabel="$p$ [Pa] (log scale)")
    axes.set_ylabel(r"$v = \phi^{-1}$ [-] (log scale)")
    for curve in curves:
        lines = compression_lines(curve.result)
        if lines is not None:
            axes.plot(span, np.exp(lines.isotropic_compression(span)), color="black", linewidth=1.2, label="ICL")
            axes.plot(span, np.exp(lines.critical_state(span)), color="red", linewidth=1.2, label="CSL")
            if lines.preconsolidation_pressure > 1.01 * lines.pressure:
                axes.plot(span, np.exp(lines.overconsolidation(span)), color="grey", linewidth=1.2, label="OCL")
        curve.draw(axes, curve.result.pressure, np.exp(curve.result.log_specific_volume))
    # A decade has too few ticks for these narrow ranges.
    for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        if limits[1] < 10.0 * limits[0]:
            axis.set_major_locator(FixedLocator(MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]).tick_values(*limits)))
            axis.set_major_formatter(_plain_numbers())
            axis.set_minor_formatter(NullFormatter())


def _draw_stress_path(axes: Axes, curves: Sequence[Curve]) -> None:
    """Deviatoric stress over pressure, with the critical state line."""
    largest = 1.5 * max(float(np.max(curve.result.pressure)) for curve in curves)
    for ratio in _critical_ratios(curves):
        axes.plot([0.0, largest], [0.0, ratio * largest], color="red", linewidth=1.2, label="CSL")
    for curve in curves:
        curve.draw(axes, curve.result.pressure, curve.result.deviatoric_stress)
    axes.set(xlabel="$p$ [Pa]", ylabel="$q$ [Pa]", xlim=(0.0, largest), ylim=(0.0, None))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(_plain_numbers())


def _plain_numbers() -> ScalarFormatter:
    """Tick labels as plain numbers, with a common power of ten for those of five digits and more."""
    formatter = ScalarFormatter(useOffset=False)
    formatter.set_powerlimits((-3, 4))
    return formatter


def _critical_ratios(curves: Sequence[Curve]) -> list[float]:
    ratios = (critical_stress_ratio(curve.result) for curve in curves)
    return sorted({round(ratio, 9) for ratio in ratios if ratio is not None})


def _draw_legend(figure: Figure, panels: NDArray[np.object_]) -> None:
    entries: dict[str, Artist] = {}
    for axes in panels:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    figure.legend(
        list(entries.values()), list(entries), loc="outside lower center", ncols=min(len(entries), 6), frameon=False
    )
