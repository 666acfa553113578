"""The volume that points bring to cells, and which cells are full of material."""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.kernels.positions import coordinate_of, position_access
from grainlaw.mpm_core.kernels.shape_functions import quadratic_weights
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.space import Space

# A cell with more than this share of its room is material, one with less is air.
FULL = 0.5
# A cell of which obstacles leave less than this share is part of them.
SOLID = 0.1
# Cells from the air within which a free surface lies: there a cell may be less than full without anything missing.
SURFACE_CELLS = 2
# By how much, in cells, a point may seem to lie beyond a side by round-off.
ROUND_OFF = 1e-6
# Cells of air around what points can reach, so that a free surface never lies at the edge of a window.
MARGIN = 2


class CellWindow(NamedTuple):
    """The cells around the points with one layer of padding: the part of the grid that volumes are looked at in.

    first     the number, along each axis, of the cell in the first layer of padding
    shape     cells along each axis, padding included
    at_walls  along each axis, whether the padding lies beyond the lower and the upper wall of the domain
    at_open   the same for open sides
    periodic  axes along which the window is the whole domain and closed
    """

    first: tuple[int, ...]
    shape: tuple[int, ...]
    at_walls: tuple[tuple[bool, bool], ...]
    at_open: tuple[tuple[bool, bool], ...]
    periodic: tuple[int, ...]


class WallGap(NamedTuple):
    """Where material is off a wall, the lower or the upper one across an axis.

    For each cell of the domain along the other axes.
    """

    axis: int
    is_lower: bool
    is_open: NDArray[np.bool_]


class Room(NamedTuple):
    """What obstacles leave of the cells of a window, and of the faces between each cell and the next along each axis.

    Shares of cells are those of what is deposited there, not of the cells themselves.
    """

    cells: NDArray[np.float64]
    faces: Sequence[NDArray[np.float64]]


class CellVolumes(NamedTuple):
    """Shares of the size of each cell of a window.

    fill  of all points
    held  of those that nothing moves apart: they carry tension, or sleep
    gaps  along which walls there is air between wall and material
    room  what obstacles leave; all of it where there are none
    """

    window: CellWindow
    fill: NDArray[np.float64]
    held: NDArray[np.float64]
    gaps: Sequence[WallGap] = ()
    room: Room | None = None

    @property
    def overfill(self) -> NDArray[np.float64]:
        """The volume of points that is too much for each cell, in sizes of a cell; negative where there is room."""
        return self.fill - (1.0 if self.room is None else self.room.cells)

    @property
    def is_material(self) -> NDArray[np.bool_]:
        """Cells that are no air; never the padding."""
        found = self.fill > (FULL if self.room is None else np.maximum(FULL * self.room.cells, SOLID))
        for axis in range(found.ndim):
            np.moveaxis(found, axis, 0)[[0, -1]] = False
        return found

    @property
    def is_held(self) -> NDArray[np.bool_]:
        """Cells of material most of which nothing moves apart."""
        return self.is_material & (self.held > 0.5 * self.fill)

    def is_interior(self) -> NDArray[np.bool_]:
        """Cells of material with no air in `SURFACE_CELLS` around them; a wall is no air where material touches it.

        Nor is the inside of an obstacle.
        """
        axes = self.fill.ndim
        no_air = self.is_material if self.room is None else self.is_material | (self.room.cells < SOLID)
        inside = no_air[(slice(1, -1),) * axes]
        for axis in range(axes):
            widths = [(SURFACE_CELLS, SURFACE_CELLS) if k == axis else (0, 0) for k in range(axes)]
            continued = np.pad(inside, widths, mode="wrap" if axis in self.window.periodic else "edge")
            inside = np.asarray(sliding_window_view(continued, 2 * SURFACE_CELLS + 1, axis=axis).all(axis=-1))
        for gap in self.gaps:
            self._open(gap, inside)
        for axis, (below, above) in enumerate(self.window.at_open):
            layers = np.moveaxis(inside, axis, 0)
            layers[: SURFACE_CELLS * below] = False
            layers[len(layers) - min(SURFACE_CELLS * above, len(layers)) :] = False
        return np.pad(inside, 1) & self.is_material

    def _open(self, gap: WallGap, inside: NDArray[np.bool_]) -> None:
        """Take out the cells that have the air of a gap before them, if its wall bounds the window."""
        if not self.window.at_walls[gap.axis][0 if gap.is_lower else 1]:
            return
        layers = np.moveaxis(inside, gap.axis, 0)
        near = layers[:SURFACE_CELLS] if gap.is_lower else layers[-SURFACE_CELLS:]
        firsts = [first + 1 for axis, first in enumerate(self.window.first) if axis != gap.axis]
        cells = tuple(slice(first, first + count) for first, count in zip(firsts, layers.shape[1:], strict=True))
        near[:, gap.is_open[cells]] = False


def find_window(bodies: Sequence[Body], grid: Grid, periodic_axes: Sequence[int]) -> CellWindow:
    """The window around all points, with a margin of air where there is room for it; somewhere, without points."""
    first, last, at_walls, at_open = [], [], [], []
    for axis, cells in enumerate(grid.cells):
        ends = [coordinate_of(body.points, axis, body.space) for body in bodies if body.count > 0]
        low_end = min((float(end.min()) for end in ends), default=grid.lower[axis])
        high_end = max((float(end.max()) for end in ends), default=grid.lower[axis])
        lowest = int((low_end - grid.lower[axis]) / grid.cell_size) - MARGIN
        highest = int((high_end - grid.lower[axis]) / grid.cell_size) + MARGIN
        closed = axis in periodic_axes
        low, high = (0, cells - 1) if closed else (max(lowest, 0), min(highest, cells - 1))
        first.append(low - 1)
        last.append(high + 1)
        at_end, is_open = (low == 0 and not closed, high == cells - 1 and not closed), grid.open_sides[axis]
        at_walls.append((at_end[0] and not is_open[0], at_end[1] and not is_open[1]))
        at_open.append((at_end[0] and is_open[0], at_end[1] and is_open[1]))
    shape = tuple(end - start + 1 for start, end in zip(first, last, strict=True))
    return CellWindow(tuple(first), shape, tuple(at_walls), tuple(at_open), tuple(periodic_axes))


def cell_volumes(
    bodies: Sequence[Body],
    grid: Grid,
    periodic_axes: Sequence[int],
    gaps: Sequence[WallGap] = (),
    room_of: Callable[[CellWindow], Room | None] = lambda window: None,
) -> CellVolumes:
    """Deposit the volumes of all points to the middles of cells, with quadratic weights, mirrored at walls.

    Points beyond an open side count for nothing. In axisymmetry a point stands for its area, volume over radius, in a
    cell whose size is its area. `room_of` tells what obstacles leave of a window.
    """
    window = find_window(bodies, grid, periodic_axes)
    fill, held = np.zeros(window.shape), np.zeros(window.shape)
    lower, per_size = corner(window, grid), grid.cell_size**-grid.space.axes
    for body in bodies:
        deposit = _make_deposit(body.space, body.precision)
        loose = body.awake if body.is_loose else 0
        deposit(body.storage, 0, loose, body.point_mass, per_size, lower, grid.cell_size, fill)
        deposit(body.storage, loose, body.count, body.point_mass, per_size, lower, grid.cell_size, held)
    fold_padding(fill, window)
    fold_padding(held, window)
    return CellVolumes(window, fill + held, held, gaps, room_of(window))


def corner(window: CellWindow, grid: Grid) -> tuple[float, ...]:
    """The lower corner of the first cell of the window, padding included [m]."""
    return tuple(low + first * grid.cell_size for low, first in zip(grid.lower, window.first, strict=True))


def fold_padding(values: NDArray[np.float64], window: CellWindow) -> None:
    """Give what lies in the padding to the cells it belongs to: beyond a wall its mirror image, or the other end.

    Beyond an open side it belongs to none.
    """
    for axis in range(values.ndim):
        layers = np.moveaxis(values, axis, 0)
        lower, upper = (-2, 1) if axis in window.periodic else (1, -2)
        below, above = window.at_open[axis]
        if not below:
            layers[lower] += layers[0]
        if not above:
            layers[upper] += layers[-1]
        layers[0] = layers[-1] = 0.0


def filled_padding(values: NDArray[Any], window: CellWindow) -> NDArray[Any]:
    """A copy whose padding continues the cells: beyond a wall their mirror image, along a periodic axis the other end.

    Elsewhere the padding is air, and stays zero.
    """
    filled = values.copy()
    for axis in range(values.ndim):
        layers = np.moveaxis(filled, axis, 0)
        if axis in window.periodic:
            layers[0], layers[-1] = layers[-2], layers[1]
        if window.at_walls[axis][0]:
            layers[0] = layers[1]
        if window.at_walls[axis][1]:
            layers[-1] = layers[-2]
    return filled


@cache
def _make_deposit(space: Space, precision: str) -> Callable[..., Any]:
    access, mark = position_access(space, precision), f"{space.name}_{precision}_{CORE_MARK}"
    density, mass_of, radius_of, hoop = access.density, access.mass, access.along, space.hoop
    make_add_volume = {2: _make_add_to_squares, 3: _make_add_to_cubes}[space.axes]
    add_volume = make_add_volume(_make_cell_and_weights(access.along, mark), mark)

    @njit(error_model="numpy", cache=True)
    @named(mark)
    def deposit(storage, begin, end, point_mass, per_size, lower, cell_size, fill):  # type: ignore[no-untyped-def]
        """Add the volumes of points, over the size of a cell, in the order in which they lie."""
        inverse = 1.0 / cell_size
        for p in range(begin, end):
            volume = mass_of(storage, p, point_mass) * per_size / density(storage, p)
            if hoop:
                volume /= radius_of(storage, 0, p)
            add_volume(storage, p, volume, lower, inverse, fill)

    return deposit


def _make_cell_and_weights(along: Callable[..., Any], mark: str) -> Callable[..., Any]:
    """A function that gives the cell that a point is in along an axis, and its weights there and in both neighbours.

    The cell of a point beyond an open side is -1.
    """

    @register_jitable(forceinline=True)
    @named(mark)
    def cell_and_weights(storage, axis, p, lower, inverse, cells):  # type: ignore[no-untyped-def]
        coordinate = (along(storage, axis, p) - lower[axis]) * inverse
        # A point on the upper wall belongs to the last cell.
        cell = min(int(coordinate), cells[axis] - 2)
        if not 1.0 - ROUND_OFF <= coordinate <= cells[axis] - 1.0 + ROUND_OFF:
            cell = -1
        # From the middle of the cell before.
        return cell, quadratic_weights(coordinate - cell + 0.5)

    return cell_and_weights


def _make_add_to_squares(cell_and_weights: Callable[..., Any], mark: str) -> Callable[..., Any]:
    @register_jitable(forceinline=True)
    @named(mark)
    def add_to_squares(storage, p, volume, lower, inverse, fill):  # type: ignore[no-untyped-def]
        i, wx = cell_and_weights(storage, 0, p, lower, inverse, fill.shape)
        j, wy = cell_and_weights(storage, 1, p, lower, inverse, fill.shape)
        if min(i, j) < 0:
            return
        for a in range(3):
            for b in range(3):
                fill[i + a - 1, j + b - 1] += volume * wx[a] * wy[b]

    return add_to_squares


def _make_add_to_cubes(cell_and_weights: Callable[..., Any], mark: str) -> Callable[..., Any]:
    @register_jitable(forceinline=True)
    @named(mark)
    def add_to_cubes(storage, p, volume, lower, inverse, fill):  # type: ignore[no-untyped-def]
        i, wx = cell_and_weights(storage, 0, p, lower, inverse, fill.shape)
        j, wy = cell_and_weights(storage, 1, p, lower, inverse, fill.shape)
        k, wz = cell_and_weights(storage, 2, p, lower, inverse, fill.shape)
        if min(i, j, k) < 0:
            return
        for a in range(3):
            for b in range(3):
                share = volume * wx[a] * wy[b]
                for c in range(3):
                    fill[i + a - 1, j + b - 1, k + c - 1] += share * wz[c]

    return add_to_cubes
