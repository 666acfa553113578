"""The pictures of a film: one figure, drawn anew for each time, with everything but the runs in its place."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from grainlaw.materials import SimulationError
from grainlaw.mpm_core.output.film_contents import FilmContents
from grainlaw.mpm_core.output.frame import Frame
from grainlaw.mpm_core.output.obstacle_drawing import draw_obstacles
from grainlaw.mpm_core.output.obstacle_series import obstacles_at
from grainlaw.mpm_core.output.picture_style import (
    LEGEND_HEIGHT,
    PAPER_WIDTH,
    color_bar,
    field_label,
    name_outlines,
    paper_style,
    scalar_values,
    time_label,
)
from grainlaw.mpm_core.output.rendering import View, draw_image, draw_visible, rendered_together, view_shape
from grainlaw.mpm_core.output.section import ShownRun

Picture = NDArray[np.uint8]
"""Red, green and blue of each pixel, shape (rows, columns, 3)."""
Image = NDArray[np.float64] | None
"""That of a view in 3D; None where VTK cannot draw, and in a plane."""

# Of the width, for panels; the rest is the colour bar and labels.
_SHARE = 0.8
# Time, labels and names around panels [inch].
_AROUND, _TITLE = 0.75, 0.25
_HIGHEST = 1.2 * PAPER_WIDTH
# Views that one process draws: starting it takes as long as drawing a few.
_TOGETHER = 16
# Of views, in whose narrower ones names of axes would run together [pixels]; they are scaled to their panels.
_NARROWEST = 900


def film_pictures(contents: FilmContents, width: int, *, side_by_side: bool) -> Iterator[Picture]:
    """The picture of each time, `width` wide and as the height an even number [pixels].

    Raises SimulationError where a view in 3D cannot be drawn though the first ones could.
    """
    figure = _FilmFigure(contents, width, side_by_side=side_by_side)
    count = len(contents.times)
    for start in range(0, count, _TOGETHER):
        numbers = range(start, min(start + _TOGETHER, count))
        frames = [[shown.run.load_frame(number) for _, shown in contents.runs] for number in numbers]
        views = figure.views(frames)
        for of_runs, images in zip(frames, views, strict=True):
            yield figure.drawn(of_runs, images)


class _FilmFigure:
    """The figure of a film: a panel for each run, the time, a colour bar, and the names of several materials."""

    def __init__(self, contents: FilmContents, width: int, *, side_by_side: bool) -> None:
        self.contents = contents
        self.field, self.scale = contents.fields[0]
        self.in_3d = contents.space.axes == 3
        count = len(contents.runs)
        self.shape = (1, count) if side_by_side else (count, 1)
        self.panel_width = _SHARE * PAPER_WIDTH / self.shape[1]
        # Rounding must not cost a pixel.
        dots = (1.0 + 1e-9) * width / PAPER_WIDTH
        height = 2 * round(0.5 * self._height() * dots) / dots * (1.0 + 1e-9)
        self.figure = Figure(figsize=(PAPER_WIDTH, height), dpi=dots, layout="compressed")
        self.canvas = FigureCanvasAgg(self.figure)
        self.panels: list[Any] = []
        self.time: Any = None

    def _height(self) -> float:
        left, right, bottom, top = self.contents.box
        shape = view_shape(self.contents.corners) if self.in_3d else (top - bottom) / (right - left)
        panel = self.panel_width * shape + _TITLE * (len(self.contents.runs) > 1)
        return min(self.shape[0] * panel + _AROUND, _HIGHEST) + LEGEND_HEIGHT * bool(self._legend())

    def _legend(self) -> Sequence[Line2D]:
        return self.contents.runs[0][1].materials.legend() if self.contents.is_outlined else []

    def views(self, frames: Sequence[Sequence[Frame]]) -> list[list[Image]]:
        """The views of frames, for each time and run; none in a plane, or where the first ones could not be drawn."""
        nothing: list[list[Image]] = [[None] * len(of_runs) for of_runs in frames]
        if not self.in_3d or (self.panels and self._is_plain()):
            return nothing
        shown = [self._view(frame, run) for of_runs in frames for frame, (_, run) in self._with_runs(of_runs)]
        images = rendered_together(shown)
        if images is None:
            if self.panels:
                raise SimulationError(f"the views from t = {frames[0][0].time:g} s on could not be drawn")
            return nothing
        count = len(self.contents.runs)
        return [list(images[start : start + count]) for start in range(0, len(images), count)]

    def drawn(self, frames: Sequence[Frame], images: Sequence[Image]) -> Picture:
        """The picture of the frames of one time."""
        with paper_style():
            if not self.panels:
                self._place_panels(plain=self.in_3d and images[0] is None)
                self._draw(frames, images)
                self._fix_places()
            self._draw(frames, images)
            self.canvas.draw()
            return np.array(self.canvas.buffer_rgba())[:, :, :3]

    def _with_runs(self, frames: Sequence[Frame]) -> Iterator[tuple[Frame, tuple[str, ShownRun]]]:
        return zip(frames, self.contents.runs, strict=True)

    def _is_plain(self) -> bool:
        """Whether matplotlib draws what VTK cannot."""
        return bool(self.panels[0].name == "3d")

    def _place_panels(self, *, plain: bool) -> None:
        grid = self.figure.add_gridspec(*self.shape)
        kind: dict[str, Any] = {"projection": "3d"} if plain else {}
        self.panels = [self.figure.add_subplot(grid[number], **kind) for number in range(len(self.contents.runs))]
        self.time = self.figure.suptitle(" ", x=0.02, ha="left")
        color_bar(self.figure, self.scale.mappable(), self.panels, field_label(self.field))
        if legend := self._legend():
            name_outlines(self.figure, legend)

    def _fix_places(self) -> None:
        """Keep the layout that the first picture asks for: nothing jumps when numbers get wider."""
        for _ in range(2):
            self.figure.draw_without_rendering()
        self.figure.set_layout_engine("none")

    def _draw(self, frames: Sequence[Frame], images: Sequence[Image]) -> None:
        self.time.set_text(time_label(frames[0].time, self.contents.decimals))
        for number, ((frame, (label, run)), image) in enumerate(zip(self._with_runs(frames), images, strict=True)):
            panel = self.panels[number]
            # Ticks, which take longest, stay.
            for drawn in [*panel.images, *panel.patches, *panel.collections]:
                drawn.remove()
            if not self.in_3d:
                self._draw_section(number, frame, run)
            elif image is not None:
                draw_image(panel, image)
            else:
                draw_visible(panel, self._view(frame, run), self.panel_width)
            if len(self.panels) > 1:
                panel.set_title(label)

    def _draw_section(self, number: int, frame: Frame, run: ShownRun) -> None:
        contents, panel, section = self.contents, self.panels[number], run.section(frame)
        left, right, *_ = box = contents.box
        if len(frame.positions):
            pixel = (right - left) / panel.get_window_extent().width
            section.draw(panel, self.field.name, self.scale, box, pixel)
        else:
            draw_obstacles(panel, section.obstacles, section.cut, box)
        across, up = section.cut.labels
        is_first, is_last = number == 0 or self.shape[0] > 1, number == len(self.panels) - 1 or self.shape[1] > 1
        panel.tick_params(labelleft=is_first, labelbottom=is_last)
        panel.set(
            xlabel=across if is_last else "", ylabel=up if is_first else "", xlim=box[:2], ylim=box[2:], aspect="equal"
        )

    def _view(self, frame: Frame, run: ShownRun) -> View:
        contents = self.contents
        return View(
            frame.positions,
            scalar_values(frame.field(self.field.name)),
            run.spacing,
            self.scale,
            run.domain,
            contents.corners,
            max(round(self.figure.bbox.width * _SHARE / self.shape[1]), _NARROWEST),
            obstacles_at(run.run.path, frame.time),
        )
