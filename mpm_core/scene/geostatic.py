"""Stress over depth: the weight of the material, of all bodies, that rests on a point, or a table."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.mpm_core.scene.body_section import BodySection, InitialStressSection
from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.scene.shapes import points_along_edge

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class _Parts(NamedTuple):
    """The squares, or cubes, that the points of some bodies stand for, in units in which their centres are whole.

    `lower` has the shape (n, axes), the others (n,).
    """

    lower: Integers
    size: Integers
    body: Integers

    @property
    def bottom(self) -> Integers:
        """The lower end along the vertical axis."""
        return self.lower[:, -1]


class _Above(NamedTuple):
    """What rests on each point: weight and surcharge [Pa]; and the depth below the top of it [m]."""

    weight: Floats
    surcharge: Floats
    depth: Floats


def vertical_stresses(scene: Scene, positions: list[Floats]) -> list[Floats]:
    """Vertical stress [Pa], tension positive, of the points of each body of `scene` at `positions`, shape (n, axes).

    With kind = "geostatic" it is the weight of the unbroken material above in the same column, and the surcharge on
    top of it. A gap narrower than a cell does not break a column: across it, bodies touch through the grid. With kind =
    "table" it is a function of the depth below the top of that material; with others it is zero.

    Raises InputError for a surcharge on a body that is covered by others and has none of it, and for a table that does
    not span the depths of its body.
    """
    parts = _parts(scene, positions)
    stresses = []
    under_others = None
    for number, section in enumerate(scene.body):
        own = parts.body == number
        if section.initial_stress.kind not in ("geostatic", "table"):
            stresses.append(np.zeros(len(positions[number])))
            continue
        if _stands_alone(parts, own):
            above = _above_in_one_body(scene, section, positions[number])
        else:
            under_others = under_others or _above_in_all_bodies(scene, parts)
            above = _Above(*(values[own] for values in under_others))
        if section.initial_stress.kind == "table":
            stresses.append(-_from_table(number, section.initial_stress, above.depth))
        else:
            _refuse_lost_surcharge(number, section.initial_stress.surcharge, above.surcharge)
            stresses.append(-(above.weight + above.surcharge))
    return stresses


def _from_table(number: int, section: InitialStressSection, depth: Floats) -> Floats:
    depths, values = np.array(section.depth), np.array(section.vertical_stress)
    if depth.min() < depths[0] or depth.max() > depths[-1]:
        raise InputError(
            f"body.{number}.initial_stress.depth spans {depths[0]:g} to {depths[-1]:g} m, "
            f"the points of the body {depth.min():g} to {depth.max():g} m"
        )
    return np.interp(depth, depths, values)


def _refuse_lost_surcharge(number: int, surcharge: float, carried: Floats) -> None:
    if carried.max() < surcharge * (1.0 - 1e-12):
        raise InputError(
            f"body.{number}.initial_stress.surcharge = {surcharge:g}: the body is covered by others everywhere; "
            "give it to the body on top, from which those below take it over"
        )


def _stands_alone(parts: _Parts, own: NDArray[np.bool_]) -> bool:
    """Whether no other body has parts above or below the box around the parts `own`."""
    lower, upper = parts.lower[:, :-1], parts.lower[:, :-1] + parts.size[:, None]
    shares = (lower < upper[own].max(axis=0)) & (upper > lower[own].min(axis=0))
    return not (shares.all(axis=1) & ~own).any()


def _above_in_one_body(scene: Scene, section: BodySection, positions: Floats) -> _Above:
    spacing = scene.grid.cell_size / points_along_edge(section.points_per_cell, scene.in_space.axes)
    depth = _depth(positions, spacing, scene.grid.cell_size)
    weight = -scene.gravity[-1] * section.density * depth
    return _Above(weight, np.full(len(depth), section.initial_stress.surcharge), depth)


def _depth(positions: Floats, spacing: float, cell_size: float) -> Floats:
    """Depth of each lattice point, ordered by columns, below the top of the unbroken material above it [m]."""
    across, height = positions[:, :-1], positions[:, -1]
    column = np.round((across - across.min(axis=0)) / spacing)
    gap = np.diff(height) - spacing
    breaks = (np.diff(column, axis=0) != 0).any(axis=1) | (gap > (1.0 - 1e-6) * cell_size)
    run = np.concatenate([[0], np.cumsum(breaks)])
    top = height[np.append(np.flatnonzero(breaks), len(positions) - 1)]
    return np.asarray(top[run] + 0.5 * spacing - height)


def _units_per_cell(scene: Scene) -> int:
    axes = scene.in_space.axes
    return 2 * math.lcm(*(points_along_edge(section.points_per_cell, axes) for section in scene.body))


def _parts(scene: Scene, positions: list[Floats]) -> _Parts:
    units = _units_per_cell(scene)
    found = []
    for number, section in enumerate(scene.body):
        size = units // points_along_edge(section.points_per_cell, scene.in_space.axes)
        spacing = scene.grid.cell_size * size / units
        indices = np.round((positions[number] - scene.grid.lower) / spacing - 0.5).astype(np.int64)
        same = np.ones(len(indices), np.int64)
        found.append(_Parts(size * indices, size * same, number * same))
    return _Parts(*(np.concatenate(values) for values in zip(*found, strict=True)))


def _above_in_all_bodies(scene: Scene, parts: _Parts) -> _Above:
    """Means over the columns that the part of each point covers."""
    units = _units_per_cell(scene)
    unit = scene.grid.cell_size / units
    specific_weight = np.array([-scene.gravity[-1] * section.density * unit for section in scene.body])
    surcharges = np.array([section.initial_stress.surcharge for section in scene.body])
    weight, surcharge, depth = np.zeros((3, len(parts.size)))
    upper, centre = parts.bottom + parts.size, parts.bottom + parts.size // 2
    for area, points in _columns(parts):
        share = area / parts.size[points] ** (scene.in_space.axes - 1)
        body = parts.body[points]
        above, top = _down_the_column(parts.bottom[points], parts.size[points], specific_weight[body], units)
        weight[points] += share * above
        surcharge[points] += share * surcharges[body[top]]
        depth[points] += share * (upper[points[top]] - centre[points]) * unit
    return _Above(weight, surcharge, depth)


def _columns(parts: _Parts) -> Iterator[tuple[int, Integers]]:
    """Area (width, in the plane) of, and points in, the columns into which all edges of parts divide the ground."""
    points = np.arange(len(parts.size))
    column, area = np.zeros((2, len(points)), np.int64)
    area += 1
    for axis in range(parts.lower.shape[1] - 1):
        lower, upper = parts.lower[:, axis], parts.lower[:, axis] + parts.size
        edges = np.unique(np.concatenate([lower, upper]))
        first = np.searchsorted(edges, lower)[points]
        covered = np.searchsorted(edges, upper)[points] - first
        into = np.repeat(np.arange(len(points)), covered)
        strip = np.arange(len(into)) - np.repeat(np.cumsum(covered) - covered - first, covered)
        points, column = points[into], column[into] * len(edges) + strip
        area = area[into] * (edges[strip + 1] - edges[strip])
    order = np.argsort(column, kind="stable")
    points, column, area = points[order], column[order], area[order]
    starts = np.flatnonzero(np.diff(column, prepend=-1))
    for start, members in zip(starts, np.split(points, starts[1:]), strict=True):
        yield int(area[start]), members


def _down_the_column(
    bottom: Integers, size: Integers, specific_weight: Floats, widest_gap: int
) -> tuple[Floats, Integers]:
    """Weight above the centre of each part [Pa], and the topmost part of its unbroken material.

    `specific_weight` is in Pa for a unit of length. Where parts of bodies with other spacings overlap, the material
    is their mean.
    """
    count = len(bottom)
    levels = np.concatenate([bottom + size, bottom + size // 2, bottom])
    enters = np.repeat([1, 0, -1], count)
    order = np.argsort(-levels, kind="stable")
    lengths = -np.diff(levels[order], append=levels.min())
    present = np.cumsum(enters[order])
    sum_of_weights = np.cumsum((enters * np.tile(specific_weight, 3))[order])
    density = np.where(present > 0, sum_of_weights / np.maximum(present, 1), 0.0)
    above = np.cumsum(density * lengths) - density * lengths
    breaks = (present == 0) & (lengths >= widest_gap)
    begins = np.concatenate([[0], np.flatnonzero(breaks[:-1]) + 1])
    begin = begins[np.searchsorted(begins, np.arange(3 * count), side="right") - 1]
    at_centre = np.empty(3 * count, np.int64)
    at_centre[order] = np.arange(3 * count)
    at_centre = at_centre[count : 2 * count]
    first = begin[at_centre]
    return above[at_centre] - above[first], order[first] % count
