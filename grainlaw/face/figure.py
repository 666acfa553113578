"""A matplotlib figure that a notebook shows, whether or not pyplot was imported."""

from io import BytesIO

from matplotlib.figure import Figure

DOTS_PER_INCH = 90


class NotebookFigure(Figure):
    """A figure without a window; a notebook shows it where it is the last value of a cell."""

    def _repr_png_(self) -> bytes:
        buffer = BytesIO()
        self.savefig(buffer, format="png", dpi=DOTS_PER_INCH)
        return buffer.getvalue()
