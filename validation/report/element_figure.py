"""The figure of the element tests: friction above, packing below, grains as dots and each law as a line."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from grainlaw.validation.dem.judging.element_verdicts import ElementVerdict
from grainlaw.validation.report.grain_figures import COLORS, MEAN
from grainlaw.validation.report.plots import data_uri

COLUMN_WIDTH, HEIGHT = 2.2, 4.4
LABELS = {
    "friction_of_mean_pressure": r"$\tau/p$",
    "solid_fraction": r"$\phi$",
    "stress_ratio": "$q/p$",
    "volumetric_strain": r"$\varepsilon_v$",
    "engineering_shear_strain": r"$\gamma$",
    "axial_strain": r"$\varepsilon_a$",
    "time": "t [s]",
}


def element_figure(found: Sequence[ElementVerdict]) -> str:
    """All tests that were drawn; empty if there are none."""
    tests = list(dict.fromkeys(curve.test for verdict in found for curve in verdict.curves))
    if not tests:
        return ""
    figure = Figure(figsize=(COLUMN_WIDTH * len(tests), HEIGHT), layout="constrained")
    columns = figure.subplots(2, len(tests), squeeze=False, sharex="col").T
    for test, axes in zip(tests, columns, strict=True):
        for number, verdict in enumerate(found):
            own = [curve for curve in verdict.curves if curve.test == test]
            for place, curve in zip(axes, own, strict=False):
                if not place.lines:
                    place.plot(curve.abscissa, curve.grains, "o", ms=2.5, color=MEAN, label="grains")
                    place.set_ylabel(LABELS[curve.quantity], fontsize=9)
                color = COLORS[number % len(COLORS)]
                place.plot(curve.abscissa, curve.of_law, color=color, lw=1.1, label=verdict.title)
                place.tick_params(labelsize=8)
                place.grid(visible=True, color="#e5e5e5", lw=0.5)
                axes[-1].set_xlabel(LABELS[curve.control], fontsize=9)
        axes[0].set_title(test, fontsize=9)
    handles, labels = columns[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=5, frameon=False, fontsize=8)
    return data_uri(figure)
