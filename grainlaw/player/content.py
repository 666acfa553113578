"""What the page is told of a run, as plain values: times, places and fields as bytes in text, obstacles, colours."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps

from grainlaw.mpm_core.output.film import rate
from grainlaw.mpm_core.output.film_contents import ColoredField, FilmContents, film_contents
from grainlaw.mpm_core.output.obstacle_series import obstacles_at
from grainlaw.mpm_core.output.picture_style import COLOR_MAP, quantity_label, scalar_values
from grainlaw.mpm_core.output.rendering import DIRECTION
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.section import ShownRun
from grainlaw.mpm_core.output.shown_field import shown_field
from grainlaw.player.packing import LEVELS, Floats, as_text, packed_places, packed_values
from grainlaw.player.shapes import Shapes
from grainlaw.player.thinning import Thinning, thinned

# Before they become text, which takes a third more: the page stays below ten megabytes.
MOST_BYTES = 7_000_000
# Obstacles that would leave less than the rest to the points are left out.
_SHARE_OF_OBSTACLES = 0.5


def page_content(run: RunFolder, most_bytes: int = MOST_BYTES) -> dict[str, Any]:
    """Everything that the page shows; `most_bytes` is what its data may take.

    Raises InputError for frames that are missing or broken.
    """
    start = run.load_frame(0)
    first = shown_field(run, start)
    names = [first, *(field.name for field in start.fields if field.name != first)]
    label = run.path.resolve().name
    contents = film_contents([(label, run)], names)
    (_, shown), axes = contents.runs[0], contents.space.axes
    shapes = _shapes(contents, shown)
    notes = []
    if shapes.size > _SHARE_OF_OBSTACLES * most_bytes:
        notes.append("Obstacles are left out: their outlines are too large for a page.")
        shapes = Shapes(shown.cuts[0])
    thinning = thinned(contents.counts[0], 2 * axes + len(names), most_bytes - shapes.size)
    times, places, values = _kept(run, thinning, axes, names)
    lower, upper = contents.corners[:, :axes]
    return {
        "run": label,
        "title": str(run.scene.get("title", "")),
        "axes": axes,
        "isMirrored": contents.space.hoop,
        "labels": [_plain(text) for text in shown.cuts[0].labels],
        "times": times,
        "decimals": contents.decimals,
        "rate": rate(len(times)),
        "counts": [len(some) for some in places],
        "lower": lower.tolist(),
        "upper": upper.tolist(),
        "box": [float(end) for end in contents.box],
        "domain": shown.domain.tolist() if axes == 3 else [],
        "direction": list(DIRECTION),
        "spacing": shown.spacing * thinning.points_each ** (1.0 / axes),
        "places": packed_places(places, lower, upper),
        "fields": [_field(one, values[one.field.name]) for one in contents.fields],
        "colors": as_text(np.rint(255 * colormaps[COLOR_MAP](np.linspace(0, 1, LEVELS))[:, :3]).astype(np.uint8)),
        "obstacles": shapes.content(thinning.frames),
        "notes": [*thinning.notes, *notes],
    }


def _kept(
    run: RunFolder, thinning: Thinning, axes: int, names: Sequence[str]
) -> tuple[list[float], list[Floats], dict[str, list[Floats]]]:
    """Times [s], places [m] and values by field of what is kept of the frames."""
    times: list[float] = []
    places: list[Floats] = []
    values: dict[str, list[Floats]] = {name: [] for name in names}
    for index in thinning.frames:
        frame = run.load_frame(index)
        numbers = thinning.numbers(len(frame.positions))
        times.append(frame.time)
        places.append(frame.positions[numbers, :axes])
        for name, of_frames in values.items():
            of_frames.append(scalar_values(frame.field(name))[numbers])
    return times, places, values


def _shapes(contents: FilmContents, shown: ShownRun) -> Shapes:
    shapes = Shapes(shown.cuts[0])
    for time in contents.times:
        shapes.add(obstacles_at(shown.run.path, float(time)), in_3d=contents.space.axes == 3)
    return shapes


def _plain(text: str) -> str:
    """A label without the signs of mathematics that pictures write it with."""
    return text.replace("$", "")


def _field(one: ColoredField, values: Sequence[Floats]) -> dict[str, Any]:
    field, scale = one
    return {
        "name": field.name,
        "label": quantity_label(field.name, field.unit),
        "lower": scale.lower,
        "upper": scale.upper,
        "values": packed_values(values, scale.lower, scale.upper),
    }
