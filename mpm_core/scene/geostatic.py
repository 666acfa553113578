"""Stress over depth: the weight of the material, of all bodies, that rests on a point, or a table."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError
from grainlaw.mpm_core.scene.model import BodySection, InitialStressSection, Scene

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class _Squares(NamedTuple):
    """The squares that the points of some bodies stand for, in units in which edges and centres are whole numbers."""

    left: Integers
    bottom: Integers
    size: Integers
    body: Integers


class _Above(NamedTuple):
    """What rests on each point: weight and surcharge [Pa]; and the depth below the top of it [m]."""

    weight: Floats
    surcharge: Floats
    depth: Floats


def vertical_stresses(scene: Scene, positions: list[Floats]) -> list[Floats]:
    """Vertical stress [Pa], tension positive, of the points of each body of `scene` at `positions`, shape (n, 2) [m].

    With kind = "geostatic" it is the weight of the unbroken material above in the same column, and the surcharge on
    top of it. A gap narrower than a cell does not break a column: across it, bodies touch through the grid. With kind =
    "table" it is a function of the depth below the top of that material; with others it is zero.

    Raises InputError for a surcharge on a body that is covered by others and has none of it, and for a table that does
    not span the depths of its body.
    """
    squares = _squares(scene, positions)
    stresses = []
    under_others = None
    for number, section in enumerate(scene.body):
        own = squares.body == number
        if section.initial_stress.kind not in ("geostatic", "table"):
            stresses.append(np.zeros(len(positions[number])))
            continue
        if _stands_alone(squares, own):
            above = _above_in_one_body(scene, section, positions[number])
        else:
            under_others = under_others or _above_in_all_bodies(scene, squares)
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


def _stands_alone(squares: _Squares, own: NDArray[np.bool_]) -> bool:
    """Whether no other body shares a column with the one that has the squares `own`."""
    first, last = squares.left[own].min(), (squares.left + squares.size)[own].max()
    shares = (squares.left < last) & (squares.left + squares.size > first) & ~own
    return not shares.any()


def _above_in_one_body(scene: Scene, section: BodySection, positions: Floats) -> _Above:
    spacing = scene.grid.cell_size / section.points_per_cell**0.5
    depth = _depth(positions, spacing, scene.grid.cell_size)
    weight = -scene.gravity[1] * section.density * depth
    return _Above(weight, np.full(len(depth), section.initial_stress.surcharge), depth)


def _depth(positions: Floats, spacing: float, cell_size: float) -> Floats:
    """Depth of each lattice point, ordered by columns, below the top of the unbroken material above it [m]."""
    column = np.round((positions[:, 0] - positions[:, 0].min()) / spacing)
    gap = np.diff(positions[:, 1]) - spacing
    breaks = (np.diff(column) != 0) | (gap > (1.0 - 1e-6) * cell_size)
    run = np.concatenate([[0], np.cumsum(breaks)])
    top = positions[np.append(np.flatnonzero(breaks), len(positions) - 1), 1]
    return np.asarray(top[run] + 0.5 * spacing - positions[:, 1])


def _units_per_cell(scene: Scene) -> int:
    return 2 * math.lcm(*(math.isqrt(section.points_per_cell) for section in scene.body))


def _squares(scene: Scene, positions: list[Floats]) -> _Squares:
    units = _units_per_cell(scene)
    parts = []
    for number, section in enumerate(scene.body):
        size = units // math.isqrt(section.points_per_cell)
        spacing = scene.grid.cell_size * size / units
        indices = np.round((positions[number] - scene.grid.lower) / spacing - 0.5).astype(np.int64)
        same = np.ones(len(indices), np.int64)
        parts.append(_Squares(size * indices[:, 0], size * indices[:, 1], size * same, number * same))
    return _Squares(*(np.concatenate(values) for values in zip(*parts, strict=True)))


def _above_in_all_bodies(scene: Scene, squares: _Squares) -> _Above:
    """Means over the columns that the square of each point covers."""
    units = _units_per_cell(scene)
    unit = scene.grid.cell_size / units
    specific_weight = np.array([-scene.gravity[1] * section.density * unit for section in scene.body])
    surcharges = np.array([section.initial_stress.surcharge for section in scene.body])
    weight, surcharge, depth = np.zeros((3, len(squares.left)))
    upper, centre = squares.bottom + squares.size, squares.bottom + squares.size // 2
    for width, points in _columns(squares):
        share = width / squares.size[points]
        body = squares.body[points]
        above, top = _down_the_column(squares.bottom[points], squares.size[points], specific_weight[body], units)
        weight[points] += share * above
        surcharge[points] += share * surcharges[body[top]]
        depth[points] += share * (upper[points[top]] - centre[points]) * unit
    return _Above(weight, surcharge, depth)


def _columns(squares: _Squares) -> Iterator[tuple[int, Integers]]:
    """Width of, and points in, each of the columns into which all edges of squares divide the plane."""
    edges = np.unique(np.concatenate([squares.left, squares.left + squares.size]))
    first = np.searchsorted(edges, squares.left)
    covered = np.searchsorted(edges, squares.left + squares.size) - first
    points = np.repeat(np.arange(len(first)), covered)
    column = np.arange(len(points)) - np.repeat(np.cumsum(covered) - covered - first, covered)
    order = np.argsort(column, kind="stable")
    column, points = column[order], points[order]
    starts = np.flatnonzero(np.diff(column, prepend=-1))
    for start, members in zip(starts, np.split(points, starts[1:]), strict=True):
        yield int(edges[column[start] + 1] - edges[column[start]]), members


def _down_the_column(
    bottom: Integers, size: Integers, specific_weight: Floats, widest_gap: int
) -> tuple[Floats, Integers]:
    """Weight above the centre of each square [Pa], and the topmost square of its unbroken material.

    `specific_weight` is in Pa for a unit of length. Where squares of bodies with other spacings overlap, the material
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
