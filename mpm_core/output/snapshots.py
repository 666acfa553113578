"""The collapse of several columns side by side, as in Figure 2 of the paper: one row per run, one column per runout.

The columns are taken at the normalised runout w_bar = (w - w0)/(w_max - w0), with w the runout of the history.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.materials_of_points import materials_of
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
from grainlaw.mpm_core.output.point_image import Box, view_box
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.section import Section, ShownRun

NORMALIZED_RUNOUTS = (0.1, 0.5, 1.0)


def normalized_runout(run: RunFolder, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """w_bar at the given times [s], between the rows of the history by linear interpolation.

    Raises InputError if the runout of the run never grew.
    """
    runout = run.history["runout"]
    growth = runout.max() - runout[0]
    if not growth > 0:
        raise InputError(f"the runout of {run.path} never grew: there is no normalised runout to choose frames by")
    return (np.interp(times, run.history["t"], runout) - runout[0]) / growth


def draw_snapshots(
    runs: Sequence[tuple[str, RunFolder]],
    path: Path,
    field: str = "shear_strain",
    limits: tuple[float, float] | None = (0.0, 3.0),
) -> None:
    """Write the picture: a row for each (label, run), the frames nearest to w_bar = 0.1, 0.5 and 1.0.

    Of a run in 3D they show the cut through the middle along x, or along y where the bodies cannot spread along x.

    Raises InputError if a run lacks frames, history or the field, or if its runout never grew.
    """
    of_runs = [materials_of(run) for _, run in runs]
    # A material has one colour in all rows.
    names = tuple(dict.fromkeys(name for materials in of_runs for name in materials.names))
    materials = [found.among(names) for found in of_runs]
    rows = [(label, _snapshots(ShownRun(run, found))) for (label, run), found in zip(runs, materials, strict=True)]
    all_sections = [section for _, row in rows for section, _ in row]
    fields = [section.frame.field(field) for section in all_sections]
    scale = color_scale([scalar_values(one) for one in fields], limits)
    box = view_box([box for section in all_sections for box in section.boxes])
    is_outlined = any(section.groups is not None for section in all_sections)
    with paper_picture(path, _height(len(rows), box) + LEGEND_HEIGHT * is_outlined, "compressed") as figure:
        grid = figure.subplots(len(rows), len(NORMALIZED_RUNOUTS), sharex=True, sharey=True, squeeze=False)
        for axes_row, (label, row) in zip(grid, rows, strict=True):
            for axes, (section, reached) in zip(axes_row, row, strict=True):
                section.draw(axes, field, scale, box)
                note = rf"$\bar{{w}} = {reached:.2f}$" + "\n" + time_label(section.frame.time)
                axes.text(0.97, 0.94, note, transform=axes.transAxes, ha="right", va="top", fontsize="small")
            cut = row[0][0].cut
            axes_row[0].set_title(f"{label}, {cut.name}" if cut.name else label, loc="left")
            axes_row[0].set_ylabel(cut.labels[1])
        for axes, target in zip(grid[0], NORMALIZED_RUNOUTS, strict=True):
            # The empty line is that of the row's label.
            axes.set_title(rf"$\bar{{w}} \approx {target:.1f}$" + "\n ")
        for axes in grid[-1]:
            axes.set_xlabel(rows[-1][1][0][0].cut.labels[0])
        grid[0, 0].set(xlim=box[:2], ylim=box[2:])
        color_bar(figure, grid[0, 0].images[0], list(grid.flat), field_label(fields[0]))
        if is_outlined:
            name_outlines(figure, materials[0].legend())


def _snapshots(shown: ShownRun) -> list[tuple[Section, float]]:
    """The frames of one run that come nearest to the three normalised runouts, and those that they have."""
    run = shown.run
    reached = normalized_runout(run, run.frame_times)
    reached[: run.first_with_points] = np.inf
    chosen = [int(np.argmin(np.abs(reached - target))) for target in NORMALIZED_RUNOUTS]
    return [(shown.section(run.load_frame(index)), float(reached[index])) for index in chosen]


def _height(rows: int, box: Box) -> float:
    """Height of the figure [inch] in which each row is as high as its equal axes need."""
    axes_width = PAPER_WIDTH / (len(NORMALIZED_RUNOUTS) + 0.8)
    axes_height = axes_width * (box[3] - box[2]) / (box[1] - box[0])
    return rows * (axes_height + 0.35) + 0.5
