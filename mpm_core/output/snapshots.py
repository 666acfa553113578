"""The collapse of several columns side by side, as in Figure 2 of the paper: one row per run, one column per runout.

The columns are taken at the normalised runout w_bar = (w - w0)/(w_max - w0), with w the runout of the history.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.cut import Cut, cuts_of, domain_of
from grainlaw.mpm_core.output.frame import Frame
from grainlaw.mpm_core.output.materials_of_points import Materials, materials_of
from grainlaw.mpm_core.output.obstacle_drawing import boxes_within, draw_obstacles
from grainlaw.mpm_core.output.obstacle_series import obstacles_at
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
from grainlaw.mpm_core.output.point_image import Box, ColorScale, bounding_box, draw_points, point_spacing, view_box
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.vtp import ObstacleFrame

NORMALIZED_RUNOUTS = (0.1, 0.5, 1.0)


@dataclass(frozen=True)
class _Snapshot:
    """A frame, its normalised runout, the first frame's spacing of points [m], their materials, and what is shown.

    `obstacles` are those of its time, `domain` the two corners of the domain [m].
    """

    frame: Frame
    normalized_runout: float
    spacing: float
    groups: NDArray[np.int64] | None
    cut: Cut
    obstacles: Sequence[ObstacleFrame]
    domain: NDArray[np.float64] | None

    @property
    def boxes(self) -> list[Box]:
        """The bounding boxes of what is shown [m]."""
        of_points = bounding_box(self.frame.positions, self.spacing, self.cut)
        return [of_points, *boxes_within(self.obstacles, self.domain, self.cut)]


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
    rows = [(label, _snapshots(run, found)) for (label, run), found in zip(runs, materials, strict=True)]
    all_snapshots = [snapshot for _, row in rows for snapshot in row]
    fields = [snapshot.frame.field(field) for snapshot in all_snapshots]
    scale = color_scale([scalar_values(one) for one in fields], limits)
    box = view_box([box for one in all_snapshots for box in one.boxes])
    is_outlined = any(one.groups is not None for one in all_snapshots)
    with paper_picture(path, _height(len(rows), box) + LEGEND_HEIGHT * is_outlined, "compressed") as figure:
        grid = figure.subplots(len(rows), len(NORMALIZED_RUNOUTS), sharex=True, sharey=True, squeeze=False)
        for axes_row, (label, row) in zip(grid, rows, strict=True):
            for axes, snapshot in zip(axes_row, row, strict=True):
                _draw_snapshot(axes, snapshot, field, scale, box)
            cut = row[0].cut
            axes_row[0].set_title(f"{label}, {cut.name}" if cut.name else label, loc="left")
            axes_row[0].set_ylabel(cut.labels[1])
        for axes, target in zip(grid[0], NORMALIZED_RUNOUTS, strict=True):
            # The empty line is that of the row's label.
            axes.set_title(rf"$\bar{{w}} \approx {target:.1f}$" + "\n ")
        for axes in grid[-1]:
            axes.set_xlabel(rows[-1][1][0].cut.labels[0])
        grid[0, 0].set(xlim=box[:2], ylim=box[2:])
        color_bar(figure, grid[0, 0].images[0], list(grid.flat), field_label(fields[0]))
        if is_outlined:
            name_outlines(figure, materials[0].legend())


def _snapshots(run: RunFolder, materials: Materials) -> list[_Snapshot]:
    """The frames of one run that come nearest to the three normalised runouts."""
    reached = normalized_runout(run, run.frame_times)
    spacing, cut = point_spacing(run.load_frame(0).positions), cuts_of(run)[0]
    chosen = [int(np.argmin(np.abs(reached - target))) for target in NORMALIZED_RUNOUTS]
    frames = [(run.load_frame(index), float(reached[index])) for index in chosen]
    found = []
    for frame, share in frames:
        obstacles = obstacles_at(run.path, frame.time)
        domain = domain_of(run) if obstacles else None
        found.append(_Snapshot(frame, share, spacing, materials.of_points(frame), cut, obstacles, domain))
    return found


def _draw_snapshot(axes: Axes, snapshot: _Snapshot, field: str, scale: ColorScale, box: Box) -> None:
    frame = snapshot.frame
    values = scalar_values(frame.field(field))
    draw_points(axes, frame.positions, values, snapshot.spacing, scale, snapshot.groups, snapshot.cut)
    draw_obstacles(axes, snapshot.obstacles, snapshot.cut, box)
    note = rf"$\bar{{w}} = {snapshot.normalized_runout:.2f}$" + "\n" + time_label(frame.time)
    axes.text(0.97, 0.94, note, transform=axes.transAxes, ha="right", va="top", fontsize="small")


def _height(rows: int, box: Box) -> float:
    """Height of the figure [inch] in which each row is as high as its equal axes need."""
    axes_width = PAPER_WIDTH / (len(NORMALIZED_RUNOUTS) + 0.8)
    axes_height = axes_width * (box[3] - box[2]) / (box[1] - box[0])
    return rows * (axes_height + 0.35) + 0.5
