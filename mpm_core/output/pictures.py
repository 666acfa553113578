"""The pictures of a run: its last frame, its history and, where a body spreads, its snapshots."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from grainlaw.mpm_core.output.cut import PLANE, Cut, cuts_of, domain_of
from grainlaw.mpm_core.output.force_picture import draw_forces
from grainlaw.mpm_core.output.forces import FORCES_NAME
from grainlaw.mpm_core.output.frame import Frame
from grainlaw.mpm_core.output.history import energy_unit, history_columns
from grainlaw.mpm_core.output.materials_of_points import Materials, materials_of
from grainlaw.mpm_core.output.obstacle_series import obstacles_at
from grainlaw.mpm_core.output.picture_style import (
    LEGEND_HEIGHT,
    PAPER_WIDTH,
    color_bar,
    color_scale,
    field_label,
    name_outlines,
    paper_picture,
    quantity_label,
    scalar_values,
    time_label,
)
from grainlaw.mpm_core.output.point_image import Box, point_spacing, view_box
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.section import Section
from grainlaw.mpm_core.output.shown_field import shown_field, usual_limits
from grainlaw.mpm_core.output.snapshots import draw_snapshots
from grainlaw.mpm_core.output.solid_picture import draw_solid_frame
from grainlaw.mpm_core.output.vtp import ObstacleFrame

_UNITS = {column.name: column.unit for column in history_columns()}
_ENERGIES = (
    "kinetic_energy",
    "potential_energy",
    "internal_work",
    "elastic_energy",
    "inelastic_work",
    "wall_work",
    "obstacle_work",
    "outflow",
    "inflow",
    "numerical_dissipation",
)
_OF_SOME = ("obstacle_work", "outflow", "inflow")
_SPREADING = 1.1


def draw_frame(
    frame: Frame,
    field: str,
    path: Path,
    limits: tuple[float, float] | None = None,
    spacing: float | None = None,
    materials: Materials | None = None,
    cut: Cut = PLANE,
    obstacles: Sequence[ObstacleFrame] = (),
    domain: NDArray[np.float64] | None = None,
) -> None:
    """Write a picture of one frame coloured by a field, a vector by its length.

    `spacing` [m] is that of the points when they were generated; without it the present distances stand in. Several
    `materials` get outlines, with their names below. `cut` is the plane that is shown;
    `obstacles` are grey, and those within the `domain`, given by its two corners [m], are shown whole.
    Raises InputError if the frame does not hold the field.
    """
    shown = frame.field(field)
    scale = color_scale([scalar_values(shown)], limits)
    spacing = point_spacing(frame.positions) if spacing is None else spacing
    groups = materials.of_points(frame) if materials is not None else None
    section = Section(frame, spacing, groups, cut, obstacles, domain)
    box = view_box(section.boxes)
    with paper_picture(path, _height(box) + LEGEND_HEIGHT * (groups is not None), "compressed") as figure:
        axes = figure.subplots()
        image = section.draw(axes, field, scale, box)
        across, up = cut.labels
        axes.set(xlabel=across, ylabel=up, xlim=box[:2], ylim=box[2:], title=time_label(frame.time))
        color_bar(figure, image, [axes], field_label(shown))
        if materials is not None and groups is not None:
            name_outlines(figure, materials.legend())


def draw_history(runs: Sequence[tuple[str, RunFolder]], path: Path) -> None:
    """Write a picture of runout, heights and energies over time: runs together above, energies of each run below.

    Raises InputError if a run holds no history.
    """
    with paper_picture(path, 0.75 * PAPER_WIDTH, "constrained") as figure:
        (above,), (below,) = figure.subfigures(2, 1, squeeze=False)
        runout, heights = above.subplots(1, 2)
        for label, run in runs:
            _draw_shape(runout, heights, label, run)
        runout.set(xlabel="$t$ [s]", ylabel=quantity_label("runout", _UNITS["runout"]))
        runout.legend(fontsize="small", frameon=False)
        shown = "height of top (full) and\ncentre of mass (dashed)"
        heights.set(xlabel="$t$ [s]", ylabel=quantity_label(shown, _UNITS["height"]))
        units = [energy_unit(run.space) for _, run in runs]
        panels = below.subplots(1, len(runs), sharey=len(set(units)) == 1, squeeze=False)[0]
        for axes, (label, run), unit in zip(panels, runs, units, strict=True):
            _draw_energies(axes, run)
            axes.set_title(label)
            if axes is panels[0] or len(set(units)) > 1:
                axes.set_ylabel(quantity_label("energy since the start", unit))
        below.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False)


def write_run_pictures(folder: Path) -> list[Path]:
    """Write final.png, history.png and, if the runout grew by more than a tenth, snapshots.png; return their paths.

    With obstacles also forces.png. final.png is of the last frame that holds material; there is none where nothing has
    entered. They show what
    `output.picture_field` of the scene says; by default the shear strain, or without it the first field that the frames
    hold. Raises InputError if the folder lacks frames or history, or if its frames hold no such field.
    """
    run = RunFolder(folder)
    last = _last_with_points(run)
    if len(last.positions) == 0:
        draw_history([(folder.name, run)], folder / "history.png")
        return [folder / "history.png"]
    field = shown_field(run, last)
    limits = usual_limits(field)
    written = [folder / "final.png", folder / "history.png"]
    spacing, cuts = point_spacing(run.load_frame(run.first_with_points).positions), cuts_of(run)
    obstacles = obstacles_at(folder, last.time)
    if run.space.axes == 3:
        draw_solid_frame(last, field, written[0], cuts, domain_of(run), limits, spacing, materials_of(run), obstacles)
    else:
        domain = domain_of(run) if obstacles else None
        draw_frame(last, field, written[0], limits, spacing, materials_of(run), cuts[0], obstacles, domain)
    draw_history([(folder.name, run)], written[1])
    runout = run.history["runout"]
    if runout.max() > _SPREADING * runout[0]:
        written.append(folder / "snapshots.png")
        draw_snapshots([(folder.name, run)], written[2], field, limits)
    if (folder / FORCES_NAME).exists():
        written.append(folder / "forces.png")
        draw_forces(run, written[-1])
    return written


def _last_with_points(run: RunFolder) -> Frame:
    """The last frame before everything has left."""
    for index in range(len(run.frame_files) - 1, 0, -1):
        frame = run.load_frame(index)
        if len(frame.positions) > 0:
            return frame
    return run.load_frame(0)


def _height(box: Box) -> float:
    """Height of the figure [inch] in which equal axes fill the width, within what a page can hold."""
    left, right, bottom, top = box
    return min(max(0.85 * PAPER_WIDTH * (top - bottom) / (right - left) + 0.8, 1.8), PAPER_WIDTH)


def _draw_shape(runout: Axes, heights: Axes, label: str, run: RunFolder) -> None:
    time = run.history["t"]
    (line,) = runout.plot(time, run.history["runout"], label=label)
    heights.plot(time, run.history["height"], color=line.get_color())
    heights.plot(time, run.history["center_of_mass_height"], "--", color=line.get_color())


def _is_idle(run: RunFolder, name: str) -> bool:
    """Whether an energy belongs to obstacles, open sides or inflows that the run does not have."""
    return name in _OF_SOME and (name not in (run.history.dtype.names or ()) or not run.history[name].any())


def _draw_energies(axes: Axes, run: RunFolder) -> None:
    columns = run.history.dtype.names or ()
    splits_work = "elastic_energy" in columns and np.isfinite(run.history["elastic_energy"]).all()
    parts, whole = {"elastic_energy", "inelastic_work"}, {"internal_work"}
    for name in _ENERGIES:
        if name not in (whole if splits_work else parts) and not _is_idle(run, name):
            axes.plot(run.history["t"], run.history[name] - run.history[name][0], label=name.replace("_", " "))
    axes.axhline(0.0, color="black", linewidth=0.5)
    axes.set_xlabel("$t$ [s]")
