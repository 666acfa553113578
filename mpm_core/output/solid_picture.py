"""The picture of a frame in 3D: a view of the whole, and below it the cuts through the middle."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.output.cut import Cut
from grainlaw.mpm_core.output.frame import Frame
from grainlaw.mpm_core.output.materials_of_points import Materials
from grainlaw.mpm_core.output.picture_style import (
    LEGEND_HEIGHT,
    PAPER_WIDTH,
    color_bar,
    color_scale,
    field_label,
    name_outlines,
    paper_picture,
    scalar_values,
    time_label,
)
from grainlaw.mpm_core.output.point_image import view_box
from grainlaw.mpm_core.output.rendering import View, draw_view, rendered
from grainlaw.mpm_core.output.section import Section
from grainlaw.mpm_core.output.vtp import ObstacleFrame

# Of the paper's width; the rest is the colour bar.
_SHARE = 0.85
_HIGHEST_VIEW = 0.5 * PAPER_WIDTH
_HIGHEST_CUT = 0.45 * PAPER_WIDTH
_LABELS = 0.5


def draw_solid_frame(
    frame: Frame,
    field: str,
    path: Path,
    cuts: Sequence[Cut],
    domain: NDArray[np.float64],
    limits: tuple[float, float] | None,
    spacing: float,
    materials: Materials,
    obstacles: Sequence[ObstacleFrame] = (),
) -> None:
    """Write the picture of a frame in 3D; `domain` are its two corners [m], the rest is that of `draw_frame`.

    Obstacles are on the cuts, not in the view of the whole, which they would hide.
    """
    shown = frame.field(field)
    values = scalar_values(shown)
    scale = color_scale([values], limits)
    groups = materials.of_points(frame)
    view = View(frame.positions, values, spacing, scale, domain)
    image = rendered(view)
    sections = [Section(frame, spacing, groups, cut, obstacles, domain) for cut in cuts]
    boxes = [view_box(section.boxes) for section in sections]
    widths = [box[1] - box[0] for box in boxes]
    height_of_view = _HIGHEST_VIEW
    if image is not None:
        height_of_view = min(_SHARE * PAPER_WIDTH * image.shape[0] / image.shape[1], _HIGHEST_VIEW)
    per_metre = _SHARE * PAPER_WIDTH / sum(widths)
    height_of_cuts = min(per_metre * max(box[3] - box[2] for box in boxes), _HIGHEST_CUT)
    height = height_of_view + height_of_cuts + 2.0 * _LABELS + LEGEND_HEIGHT * (groups is not None)
    with paper_picture(path, height, "constrained") as figure:
        ratios = [height_of_view + 0.5 * _LABELS, height_of_cuts + _LABELS]
        grid = figure.add_gridspec(2, len(cuts), height_ratios=ratios, width_ratios=widths)
        whole = draw_view(figure, grid[0, :], view, image, _HIGHEST_VIEW)
        whole.set_title(time_label(frame.time))
        panels = []
        for number, (section, box) in enumerate(zip(sections, boxes, strict=True)):
            axes = figure.add_subplot(grid[1, number])
            drawn = section.draw(axes, field, scale, box)
            across, up = section.cut.labels
            axes.set(xlabel=across, ylabel=up, xlim=box[:2], ylim=box[2:], title=section.cut.name)
            panels.append(axes)
        color_bar(figure, drawn, [whole, *panels], field_label(shown))
        if groups is not None:
            name_outlines(figure, materials.legend())
