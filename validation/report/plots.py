"""The figures of the report as PNG images within the page."""

import base64
import io
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas
from matplotlib.ticker import LogFormatter

from grainlaw.validation.case import Convergence, Curve, Figure

WIDTH, HEIGHT, RESOLUTION = 5.2, 3.6, 110
MEASURED_COLORS = ("#d95f02", "#1b9e77", "#7570b3", "#e7298a")
REFERENCE_COLORS = ("#333333", "#999999", "#c0a060")
MANY_POINTS = 40


def figure_image(figure: Figure) -> str:
    """One figure as a data URI."""
    canvas, axes = _axes(figure.title, figure.x_label, figure.y_label)
    colors, references = cycle(MEASURED_COLORS), cycle(REFERENCE_COLORS)
    for curve in figure.curves:
        _draw(axes, curve, next(references if curve.role == "reference" else colors))
    for name in figure.logarithmic:
        axes.set(**{f"{name}scale": "log"})
        getattr(axes, f"{name}axis").set(major_formatter=LogFormatter(), minor_formatter=LogFormatter())
    axes.legend(frameon=False, fontsize=8)
    return data_uri(canvas)


def convergence_image(found: Convergence) -> str:
    """Errors over sizes in logarithmic axes, with the fitted slope."""
    canvas, axes = _axes(f"Convergence: {found.name}", found.against, "error")
    sizes = np.array(found.sizes)
    slope, offset = np.polyfit(np.log(sizes), np.log(found.errors), 1)
    axes.loglog(sizes, np.exp(offset) * sizes**slope, color="#333333", lw=1, label=f"order {slope:.2f}")
    axes.loglog(sizes, found.errors, "o", color=MEASURED_COLORS[0], ms=5, label="measured")
    axes.legend(frameon=False, fontsize=8)
    return data_uri(canvas)


def _axes(title: str, x_label: str, y_label: str) -> tuple[Canvas, Axes]:
    canvas = Canvas(figsize=(WIDTH, HEIGHT), layout="constrained")
    axes = canvas.add_subplot()
    axes.set_title(title, fontsize=10)
    axes.set_xlabel(x_label, fontsize=9)
    axes.set_ylabel(y_label, fontsize=9)
    axes.tick_params(labelsize=8)
    axes.grid(visible=True, color="#dddddd", lw=0.5)
    return canvas, axes


def _draw(axes: Axes, curve: Curve, color: str) -> None:
    if curve.role == "reference":
        axes.plot(curve.x, curve.y, color=color, lw=1.2, label=curve.label)
    elif curve.role == "control":
        axes.plot(curve.x, curve.y, color=color, lw=1.0, ls="--", label=curve.label)
    else:
        size = 2.0 if len(curve.x) > MANY_POINTS else 4.0
        axes.plot(curve.x, curve.y, "o", color=color, ms=size, label=curve.label)


def data_uri(canvas: Canvas) -> str:
    """A figure as a data URI, so that the page needs no other file."""
    buffer = io.BytesIO()
    canvas.savefig(buffer, format="png", dpi=RESOLUTION)
    return embedded(buffer.getvalue())


def embedded(picture: bytes) -> str:
    """A PNG file as a data URI."""
    return "data:image/png;base64," + base64.b64encode(picture).decode("ascii")
