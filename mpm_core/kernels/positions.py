"""Where points are, and how dense: as exactly as doubles say, whatever the rest of a point is stored as.

A single divides a domain into some ten million parts, and a slow point moves by less in a step; so with density. Points
in single precision therefore keep, in rows at their end, what singles leave out of both.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.kernels.rows import rows_of
from grainlaw.mpm_core.kernels.simd.arithmetic import narrowed, widened
from grainlaw.mpm_core.kernels.simd.registers import put, several_at
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.layout import DENSITY_REMAINDER, layout_of
from grainlaw.mpm_core.space import Space


def coordinate_of(points: NDArray[Any], axis: int, space: Space) -> NDArray[np.float64]:
    """Coordinate of points along an axis in double precision, not to be written to, shape (n,) [m]."""
    coordinate: NDArray[Any] = points[axis]
    if points.dtype == np.float64:
        return coordinate
    return coordinate.astype(np.float64) + points[layout_of(space).position_remainder + axis]


def positions_of(points: NDArray[Any], space: Space) -> NDArray[np.float64]:
    """Coordinates of points in double precision, shape (axes, n) [m].

    A view where that is how they are stored, else a copy that cannot be written to.
    """
    if points.dtype == np.float64:
        return points[: space.axes]
    positions = np.stack([coordinate_of(points, axis, space) for axis in range(space.axes)])
    # Writing to a copy would move no point.
    positions.setflags(write=False)
    return positions


def put_coordinate(points: NDArray[Any], axis: int, coordinate: NDArray[np.float64], space: Space) -> None:
    """Move points along an axis to a coordinate, shape (n,) [m]."""
    points[axis] = coordinate
    if points.dtype == np.float32:
        points[layout_of(space).position_remainder + axis] = coordinate - points[axis]


def put_positions(points: NDArray[Any], positions: NDArray[np.float64], space: Space) -> None:
    """Move points to coordinates, shape (axes, n) [m]."""
    for axis, coordinate in enumerate(positions):
        put_coordinate(points, axis, coordinate, space)


def put_density(points: NDArray[Any], density: float, space: Space) -> None:
    """Give all points a density [kg/m3]."""
    row = layout_of(space).density
    points[row] = density
    if points.dtype == np.float32:
        points[DENSITY_REMAINDER] = density - float(points[row, 0])


def density_of_first(points: NDArray[Any], space: Space) -> float:
    """The density of the first point in double precision [kg/m3]."""
    rest = float(points[DENSITY_REMAINDER, 0]) if points.dtype == np.float32 else 0.0
    return float(points[layout_of(space).density, 0]) + rest


class PositionAccess(NamedTuple):
    """What compiled code reads and stores places with.

    rows       (storage) -> the rows that every law has, and those that `at` and `put` need
    at         (rows, p) -> the coordinates of four points, or eight in single precision, a tuple over the axes
    put        (rows, p, coordinates)
    along      (storage, axis, p) -> the coordinate of a point along an axis
    put_along  (storage, axis, p, coordinate)
    density    (storage, p) -> the density of a point
    mass       (storage, p, point_mass) -> the mass of a point, which is its own in axisymmetry
    """

    rows: Callable[..., Any]
    at: Callable[..., Any]
    put: Callable[..., Any]
    along: Callable[..., Any]
    put_along: Callable[..., Any]
    density: Callable[..., Any]
    mass: Callable[..., Any]


@cache
def position_access(space: Space, precision: str) -> PositionAccess:
    """The access for points of a space in a precision."""
    layout, mark = layout_of(space), f"{space.name}_{precision}_{CORE_MARK}"
    density_row, mass_row, remainder = layout.density, layout.mass, layout.position_remainder
    of_every_law, x_found = (0.0,) * layout.first_state, layout.first_state

    @register_jitable(forceinline=True)
    @named(mark)
    def all_rows(storage):  # type: ignore[no-untyped-def]
        return rows_of(storage, of_every_law)

    @register_jitable(forceinline=True)
    @named(mark)
    def along(storage, axis, p):  # type: ignore[no-untyped-def]
        return storage[axis, p]

    @register_jitable(forceinline=True)
    @named(mark)
    def put_along(storage, axis, p, coordinate):  # type: ignore[no-untyped-def]
        storage[axis, p] = coordinate

    @register_jitable(forceinline=True)
    @named(mark)
    def density(storage, p):  # type: ignore[no-untyped-def]
        return storage[density_row, p]

    @register_jitable(forceinline=True)
    @named(mark)
    def along_in_single(storage, axis, p):  # type: ignore[no-untyped-def]
        return np.float64(storage[axis, p]) + storage[remainder + axis, p]

    @register_jitable(forceinline=True)
    @named(mark)
    def put_along_in_single(storage, axis, p, coordinate):  # type: ignore[no-untyped-def]
        storage[axis, p] = coordinate
        storage[remainder + axis, p] = coordinate - storage[axis, p]

    @register_jitable(forceinline=True)
    @named(mark)
    def density_in_single(storage, p):  # type: ignore[no-untyped-def]
        return np.float64(storage[density_row, p]) + storage[DENSITY_REMAINDER, p]

    @register_jitable(forceinline=True)
    @named(mark)
    def own_mass(storage, p, point_mass):  # type: ignore[no-untyped-def]
        return np.float64(storage[mass_row, p])

    mass = own_mass if space.hoop else _common_mass
    if precision == "double":
        return PositionAccess(all_rows, _at[space.axes], _put[space.axes], along, put_along, density, mass)
    at, put_at = _in_single(space.axes, x_found, mark)
    rows = _rows_and_remainders(space.axes, of_every_law, remainder, mark)
    return PositionAccess(rows, at, put_at, along_in_single, put_along_in_single, density_in_single, mass)


@register_jitable(forceinline=True)
def _common_mass(storage, p, point_mass):  # type: ignore[no-untyped-def]
    return point_mass


@register_jitable(forceinline=True)
def _at_2(rows, p):  # type: ignore[no-untyped-def]
    return several_at(rows[0], p), several_at(rows[1], p)


@register_jitable(forceinline=True)
def _at_3(rows, p):  # type: ignore[no-untyped-def]
    return several_at(rows[0], p), several_at(rows[1], p), several_at(rows[2], p)


@register_jitable(forceinline=True)
def _put_2(rows, p, position):  # type: ignore[no-untyped-def]
    put(rows[0], p, position[0])
    put(rows[1], p, position[1])


@register_jitable(forceinline=True)
def _put_3(rows, p, position):  # type: ignore[no-untyped-def]
    put(rows[0], p, position[0])
    put(rows[1], p, position[1])
    put(rows[2], p, position[2])


_at, _put = {2: _at_2, 3: _at_3}, {2: _put_2, 3: _put_3}


@register_jitable(forceinline=True)
def _both(row, remainder, p):  # type: ignore[no-untyped-def]
    return widened(several_at(row, p)) + widened(several_at(remainder, p))


@register_jitable(forceinline=True)
def _put_both(row, remainder, p, coordinate):  # type: ignore[no-untyped-def]
    single = narrowed(coordinate)
    put(row, p, single)
    put(remainder, p, coordinate - widened(single))


def _rows_and_remainders(axes: int, of_every_law: tuple[float, ...], remainder: int, mark: str) -> Callable[..., Any]:
    """A function that hands on the rows of every law, and behind them the remainders of the coordinates."""

    @register_jitable(forceinline=True)
    @named(mark)
    def rows_2(storage):  # type: ignore[no-untyped-def]
        return (*rows_of(storage, of_every_law), storage[remainder], storage[remainder + 1])

    @register_jitable(forceinline=True)
    @named(mark)
    def rows_3(storage):  # type: ignore[no-untyped-def]
        return (
            *rows_of(storage, of_every_law),
            storage[remainder],
            storage[remainder + 1],
            storage[remainder + 2],
        )

    return {2: rows_2, 3: rows_3}[axes]


def _in_single(axes: int, found: int, mark: str) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Functions that load and store coordinates whose remainders stand in the rows from `found` on."""
    found_y, found_z = found + 1, found + 2

    @register_jitable(forceinline=True)
    @named(mark)
    def at_2(rows, p):  # type: ignore[no-untyped-def]
        return _both(rows[0], rows[found], p), _both(rows[1], rows[found_y], p)

    @register_jitable(forceinline=True)
    @named(mark)
    def at_3(rows, p):  # type: ignore[no-untyped-def]
        return _both(rows[0], rows[found], p), _both(rows[1], rows[found_y], p), _both(rows[2], rows[found_z], p)

    @register_jitable(forceinline=True)
    @named(mark)
    def put_2(rows, p, position):  # type: ignore[no-untyped-def]
        _put_both(rows[0], rows[found], p, position[0])
        _put_both(rows[1], rows[found_y], p, position[1])

    @register_jitable(forceinline=True)
    @named(mark)
    def put_3(rows, p, position):  # type: ignore[no-untyped-def]
        put_2(rows, p, position)
        _put_both(rows[2], rows[found_z], p, position[2])

    return ({2: at_2, 3: at_3}[axes], {2: put_2, 3: put_3}[axes])
