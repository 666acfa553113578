"""What all pictures share: width, font size, colours, labels with units, and how they reach the disk."""

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from grainlaw.materials import atomic
from grainlaw.mpm_core.output.frame import Field
from grainlaw.mpm_core.output.point_image import ColorScale

PAPER_WIDTH = 7.2
"""Width of a figure over both columns of a page [inch]."""

LEGEND_HEIGHT = 0.3
"""What the names of outlined materials take below a picture [inch]."""

COLOR_MAP = "copper"
_DOTS_PER_INCH = 250
_STYLE: Any = {"font.size": 8.0, "font.family": "serif", "mathtext.fontset": "cm", "axes.linewidth": 0.6}


def paper_style() -> AbstractContextManager[None]:
    """Fonts and lines of all pictures while it lasts."""
    return rc_context(_STYLE)


@contextmanager
def paper_picture(path: Path, height: float, layout: Literal["compressed", "constrained"]) -> Iterator[Figure]:
    """Yield an empty figure of the paper's width and the given height [inch]; write it as PNG when all went well."""
    with paper_style():
        figure = Figure(figsize=(PAPER_WIDTH, height), layout=layout)
        yield figure
        # The ticks follow from the size of the axes that the first layout gives: the second one leaves room for them.
        figure.draw_without_rendering()
        with atomic.replacing(path) as partial:
            figure.savefig(partial, dpi=_DOTS_PER_INCH)


def scalar_values(field: Field) -> NDArray[np.float64]:
    """Values of shape (points,): a scalar as it is, a vector by its length."""
    return field.values if field.values.ndim == 1 else np.linalg.norm(field.values, axis=1)


def field_label(field: Field) -> str:
    """Name and unit of a field as they stand beside a colour bar."""
    return quantity_label(field.name, field.unit)


def quantity_label(name: str, unit: str) -> str:
    """A name in words with its unit in brackets; a pure number has none."""
    words = name.replace("_", " ")
    return words if unit in {"", "1"} else f"{words} [{unit}]"


def time_label(time: float, decimals: int | None = None) -> str:
    """A time [s] as it stands on a picture: by three digits, or where it is one of many with as many decimals."""
    shown = f"{time:.3g}" if decimals is None else f"{time:.{decimals}f}"
    return rf"$t = {shown}\,\mathrm{{s}}$"


def color_scale(values: Sequence[NDArray[np.float64]], limits: tuple[float, float] | None) -> ColorScale:
    """The given limits, or else those that leave out one percent of all values at each end."""
    lower, upper = limits if limits is not None else np.percentile(np.concatenate(values), (1, 99))
    return ColorScale(COLOR_MAP, float(lower), float(upper) if upper > lower else float(lower) + 1.0)


def color_bar(figure: Figure, image: ScalarMappable, axes: list[Axes], label: str) -> None:
    """One colour bar to the right of the axes; its arrows say that values beyond the scale look like those at its end.

    A scale that starts at zero belongs to a quantity that is never negative.
    """
    extend = "max" if image.get_clim()[0] == 0.0 else "both"
    bar = figure.colorbar(image, ax=axes, extend=extend, label=label, shrink=0.9, aspect=25, pad=0.02)
    bar.outline.set_linewidth(0.6)


def name_outlines(figure: Figure, lines: Sequence[Line2D]) -> None:
    """The names of outlined materials in a row below everything."""
    figure.legend(handles=lines, loc="outside lower center", ncols=len(lines), frameon=False)
