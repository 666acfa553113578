"""What a film shows: its runs, the times that they have in common, and one box and colour scale for all frames."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.frame import Field, Frame
from grainlaw.mpm_core.output.materials_of_points import materials_of
from grainlaw.mpm_core.output.picture_style import color_scale, scalar_values
from grainlaw.mpm_core.output.point_image import Box, ColorScale, view_box
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.section import Section, ShownRun
from grainlaw.mpm_core.output.shown_field import usual_limits
from grainlaw.mpm_core.space import Space

# Values of a frame from which the colour scale is found, so that long runs of many points fit into memory.
VALUES_SAMPLED = 20_000
# Times are the same within this share of the time between two frames.
_TOLERANCE = 1e-3


class ColoredField(NamedTuple):
    """A field, whose values are those of one frame, and its colours in all of them."""

    field: Field
    scale: ColorScale


@dataclass(frozen=True)
class FilmContents:
    """Runs with their labels, and what holds for all frames.

    fields       what colours can show
    box          what a picture in a plane holds: left, right, bottom, top [m]
    corners      lowest and highest places of all that is shown, shape (2, 3) [m]
    counts       of points in the frames of each run
    is_outlined  whether materials of a run are told apart
    """

    runs: Sequence[tuple[str, ShownRun]]
    times: NDArray[np.float64]
    space: Space
    fields: Sequence[ColoredField]
    box: Box
    corners: NDArray[np.float64]
    counts: Sequence[Sequence[int]]
    is_outlined: bool

    @property
    def decimals(self) -> int:
        """How many decimals tell two times from one another."""
        apart = float(np.diff(self.times).min()) if len(self.times) > 1 else float(self.times[-1]) or 1.0
        return min(max(int(np.ceil(-np.log10(apart))) + 1, 0), 9)


def film_contents(runs: Sequence[tuple[str, RunFolder]], names: Sequence[str]) -> FilmContents:
    """Look through all frames of each (label, run) for the fields of these names.

    Raises InputError for frames or a field that a run does not have, for runs that do not go together, and where no
    frame holds a point.
    """
    first = runs[0][1]
    for _, run in runs[1:]:
        _refuse_others(run, first)
    materials = [materials_of(run) for _, run in runs]
    # A material has one colour in all panels.
    all_names = tuple(dict.fromkeys(one for found in materials for one in found.names))
    shown = [
        (label, ShownRun(run, found.among(all_names))) for (label, run), found in zip(runs, materials, strict=True)
    ]
    values: dict[str, list[NDArray[np.float64]]] = {name: [] for name in names}
    boxes: list[Box] = []
    corners: list[NDArray[np.float64]] = []
    counts: list[list[int]] = []
    is_outlined = False
    for _, one in shown:
        counts.append([])
        for index in range(len(one.run.frame_files)):
            frame = one.run.load_frame(index)
            for name, of_frames in values.items():
                of_frames.append(_some(scalar_values(_field(one.run, frame, name))))
            section = one.section(frame)
            boxes += section.boxes
            is_outlined |= section.groups is not None
            corners += _corners(frame, section)
            counts[-1].append(len(frame.positions))
    if not any(map(sum, counts)):
        raise InputError(f"{first.path}: no frame holds a point")
    extent = np.array([np.min(corners, axis=0), np.max(corners, axis=0)])
    start = first.load_frame(0)
    fields = [ColoredField(start.field(name), _scale(of_frames, name)) for name, of_frames in values.items()]
    return FilmContents(shown, first.frame_times, first.space, fields, view_box(boxes), extent, counts, is_outlined)


def _scale(values: Sequence[NDArray[np.float64]], name: str) -> ColorScale:
    # Where no value is finite any scale will do.
    found = values if any(len(some) for some in values) else [np.zeros(1)]
    return color_scale(found, usual_limits(name))


def _corners(frame: Frame, section: Section) -> list[NDArray[np.float64]]:
    """Lowest and highest places of points, and of the obstacles that lie within a domain in 3D [m]."""
    shown = [frame.positions] if len(frame.positions) else []
    domain = section.domain
    if domain is not None and domain.shape[1] == 3:
        bodies = [obstacle.outline.points for obstacle in section.obstacles if not obstacle.hollow]
        shown += [points for points in bodies if len(points) and ((points > domain[0]) & (points < domain[1])).all()]
    return [end for points in shown for end in (points.min(axis=0), points.max(axis=0))]


def _some(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Finite values for the colour scale."""
    some = values[:: max(1, len(values) // VALUES_SAMPLED)]
    return some[np.isfinite(some)]


def _field(run: RunFolder, frame: Frame, name: str) -> Field:
    try:
        return frame.field(name)
    except InputError as error:
        raise InputError(f"{run.path}: {error}") from None


def _refuse_others(run: RunFolder, first: RunFolder) -> None:
    if run.space != first.space:
        spaces = f"{run.path} is in {run.space.name}, {first.path} in {first.space.name}"
        raise InputError(f"{spaces}: a film shows runs in one space")
    times, expected = run.frame_times, first.frame_times
    apart = float(expected[-1] - expected[0]) / max(len(expected) - 1, 1)
    if len(times) != len(expected) or np.abs(times - expected).max() > _TOLERANCE * apart:
        raise InputError(
            f"{run.path} has {_series(times)}, {first.path} {_series(expected)}: a film shows runs at equal times; "
            "give them one time.end and output.interval"
        )


def _series(times: NDArray[np.float64]) -> str:
    return f"{len(times)} frames up to {times[-1]:g} s"
