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

from grainlaw.mpm_core.kernels.rows import OF_EVERY_LAW, rows_of
from grainlaw.mpm_core.kernels.simd.arithmetic import narrowed, widened
from grainlaw.mpm_core.kernels.simd.registers import put, several_at
from grainlaw.mpm_core.layout import DENSITY, DENSITY_REMAINDER, FIRST_STATE, X_REMAINDER, Y_REMAINDER, X, Y

# Where `PositionAccess.rows` hands on the rows at the end.
_FOUND_X, _FOUND_Y = FIRST_STATE, FIRST_STATE + 1


def coordinate_of(points: NDArray[Any], axis: int) -> NDArray[np.float64]:
    """Coordinate of points along an axis in double precision, not to be written to, shape (n,) [m]."""
    coordinate: NDArray[Any] = points[(X, Y)[axis]]
    if points.dtype == np.float64:
        return coordinate
    return coordinate.astype(np.float64) + points[(X_REMAINDER, Y_REMAINDER)[axis]]


def positions_of(points: NDArray[Any]) -> NDArray[np.float64]:
    """Coordinates of points in double precision, shape (2, n) [m].

    A view where that is how they are stored, else a copy that cannot be written to.
    """
    if points.dtype == np.float64:
        return points[X : Y + 1]
    positions = np.stack([coordinate_of(points, axis) for axis in (0, 1)])
    # Writing to a copy would move no point.
    positions.setflags(write=False)
    return positions


def put_coordinate(points: NDArray[Any], axis: int, coordinate: NDArray[np.float64]) -> None:
    """Move points along an axis to a coordinate, shape (n,) [m]."""
    row = (X, Y)[axis]
    points[row] = coordinate
    if points.dtype == np.float32:
        points[(X_REMAINDER, Y_REMAINDER)[axis]] = coordinate - points[row]


def put_positions(points: NDArray[Any], positions: NDArray[np.float64]) -> None:
    """Move points to coordinates, shape (2, n) [m]."""
    for axis, coordinate in enumerate(positions):
        put_coordinate(points, axis, coordinate)


def put_density(points: NDArray[Any], density: float) -> None:
    """Give all points a density [kg/m3]."""
    points[DENSITY] = density
    if points.dtype == np.float32:
        points[DENSITY_REMAINDER] = density - float(points[DENSITY, 0])


def density_of_first(points: NDArray[Any]) -> float:
    """The density of the first point in double precision [kg/m3]."""
    rest = float(points[DENSITY_REMAINDER, 0]) if points.dtype == np.float32 else 0.0
    return float(points[DENSITY, 0]) + rest


class PositionAccess(NamedTuple):
    """What compiled code reads and stores places with.

    rows     (storage) -> the rows that every law has, and those that `at` and `put` need
    at       (rows, p) -> x, y of four points, or eight in single precision
    put      (rows, p, x, y)
    along    (storage, axis, p) -> the coordinate of a point along an axis
    density  (storage, p) -> the density of a point
    put_along  (storage, axis, p, coordinate)
    """

    rows: Callable[..., Any]
    at: Callable[..., Any]
    put: Callable[..., Any]
    along: Callable[..., Any]
    density: Callable[..., Any]
    put_along: Callable[..., Any]


@cache
def position_access(precision: str) -> PositionAccess:
    """The access for points in a precision."""
    if precision == "double":
        return PositionAccess(_all_rows, _at, _put, _along, _density, _put_along)
    return PositionAccess(_rows_and_remainders, _at_both, _put_both, _along_both, _density_both, _put_along_both)


@register_jitable(forceinline=True)
def _all_rows(storage):  # type: ignore[no-untyped-def]
    return rows_of(storage, OF_EVERY_LAW)


@register_jitable(forceinline=True)
def _at(rows, p):  # type: ignore[no-untyped-def]
    return several_at(rows[X], p), several_at(rows[Y], p)


@register_jitable(forceinline=True)
def _put(rows, p, x, y):  # type: ignore[no-untyped-def]
    put(rows[X], p, x)
    put(rows[Y], p, y)


@register_jitable(forceinline=True)
def _rows_and_remainders(storage):  # type: ignore[no-untyped-def]
    return (*rows_of(storage, OF_EVERY_LAW), storage[X_REMAINDER], storage[Y_REMAINDER])


@register_jitable(forceinline=True)
def _at_both(rows, p):  # type: ignore[no-untyped-def]
    x, y = widened(several_at(rows[X], p)), widened(several_at(rows[Y], p))
    return x + widened(several_at(rows[_FOUND_X], p)), y + widened(several_at(rows[_FOUND_Y], p))


@register_jitable(forceinline=True)
def _put_both(rows, p, x, y):  # type: ignore[no-untyped-def]
    single_x, single_y = narrowed(x), narrowed(y)
    put(rows[X], p, single_x)
    put(rows[Y], p, single_y)
    put(rows[_FOUND_X], p, x - widened(single_x))
    put(rows[_FOUND_Y], p, y - widened(single_y))


@register_jitable(forceinline=True)
def _along(storage, axis, p):  # type: ignore[no-untyped-def]
    return storage[axis, p]


@register_jitable(forceinline=True)
def _along_both(storage, axis, p):  # type: ignore[no-untyped-def]
    return np.float64(storage[axis, p]) + storage[X_REMAINDER + axis, p]


@register_jitable(forceinline=True)
def _density(storage, p):  # type: ignore[no-untyped-def]
    return storage[DENSITY, p]


@register_jitable(forceinline=True)
def _density_both(storage, p):  # type: ignore[no-untyped-def]
    return np.float64(storage[DENSITY, p]) + storage[DENSITY_REMAINDER, p]


@register_jitable(forceinline=True)
def _put_along(storage, axis, p, coordinate):  # type: ignore[no-untyped-def]
    storage[axis, p] = coordinate


@register_jitable(forceinline=True)
def _put_along_both(storage, axis, p, coordinate):  # type: ignore[no-untyped-def]
    storage[axis, p] = coordinate
    storage[X_REMAINDER + axis, p] = coordinate - storage[axis, p]
