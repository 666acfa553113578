"""Volume projection: points of loose material are moved apart until they leave each cell the room it has.

Points carry volumes that they integrate themselves. In long flows their positions crowd, or thin out, while the volumes
do not know. An implicit density projection, as for fluids (Kugelstadt, Longva, Thuerey & Bender 2019, IEEE TVCG 27,
2994), moves the points, and nothing else of them:

    lap psi = V/h^2 - 1,    x <- x + grad psi

with the volume V that points bring to a cell. Where an obstacle cuts a cell, 1 is what is left of it. In axisymmetry V
is the area V/r, with (1/r) d(r dpsi/dr)/dr for the derivatives along the radius. psi is zero in the air, and nothing
moves through a wall or an obstacle, through material that carries tension, or through what sleeps. A cell near a free
surface, or near a wall that the material does not touch, may be less than full; more than full it may not be.
Differences of psi across the faces of cells are interpolated linearly at the points.

It is done when the fastest point has drifted far enough since the last time: the intervals follow from the motion, not
from the step, and at rest there are none.
"""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.extending import register_jitable
from numpy.typing import NDArray

from grainlaw.materials.compilation import named
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.grid.cell_volumes import (
    CellVolumes,
    CellWindow,
    Room,
    WallGap,
    cell_volumes,
    corner,
    filled_padding,
)
from grainlaw.mpm_core.grid.elliptic import solve
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.kernels.law_at_points import replaced
from grainlaw.mpm_core.kernels.positions import position_access
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.mpm_core.space import Space

# The root mean square of what is left of the overfill [1].
TOLERANCE = 1e-3
# The compressibility that lets a container that is full to its lid be solved for, in units of the cell size.
COMPRESSIBILITY = 1e-6
# Short waves lose most of their height in the deposit and in the interpolation of ways. So much of the overfill itself,
# in squares of the cell size, makes up for it: a wave four cells long goes in one projection, and none grows.
SHARPENING = 0.25
# Cells by which the fastest point may drift between two projections.
LONGEST_UNPROJECTED = 0.6
# The longest way of a face, in cells; what is left is done the next time. No point can then pass a wall.
LONGEST_WAY = 0.25


class Projected(NamedTuple):
    """What a projection did.

    raised       potential energy that the points gained [J]
    bounded      number of faces that would have been moved farther than `LONGEST_WAY`
    longest_way  of a point [m]
    iterations   of the solver
    """

    raised: float
    bounded: int
    longest_way: float
    iterations: int


def project_volumes(
    bodies: Sequence[Body],
    grid: Grid,
    periodic_axes: Sequence[int],
    gravity: tuple[float, ...],
    gaps: Sequence[WallGap] = (),
    room_of: Callable[[CellWindow], Room | None] = lambda window: None,
) -> Projected:
    """Move the points of loose bodies that are awake so that each cell has the volume it has room for.

    `room_of` tells what obstacles leave of a window.

    Points must lie in the domain. Raises SimulationError if the elliptic problem does not converge.
    """
    volumes = cell_volumes(bodies, grid, periodic_axes, gaps, room_of)
    overfill = _overfill(volumes)
    is_unknown = volumes.is_material & ~volumes.is_held
    faces = _faces(volumes)
    cell_radii, face_radii = _radii(grid, volumes.window)
    zeroth = np.full(overfill.shape, COMPRESSIBILITY) * cell_radii
    conductances = [faces[0] * face_radii, *(along * cell_radii for along in faces[1:])]
    psi, iterations = solve(zeroth, conductances, is_unknown, -overfill * cell_radii, periodic_axes, TOLERANCE)
    psi -= SHARPENING * np.where(is_unknown, overfill, 0.0)
    raised, bounded, longest = 0.0, 0, 0.0
    if iterations > 0:
        ways = _ways(psi, faces, volumes.window)
        cells = (slice(1, -1),) * overfill.ndim
        bounded = sum(int(np.count_nonzero(np.abs(way[cells]) > LONGEST_WAY)) for way in ways)
        ways = [np.clip(way, -LONGEST_WAY, LONGEST_WAY) for way in ways]
        for body in bodies:
            if body.is_loose:
                move = _make_move(body.space, body.precision)
                place = corner(volumes.window, grid), grid.cell_size
                risen, way = move(body.storage, body.awake, body.point_mass, *place, tuple(ways), gravity)
                raised += risen
                longest = max(longest, way)
    return Projected(raised, bounded, longest, iterations)


def _radii(grid: Grid, window: CellWindow) -> tuple[NDArray[np.float64] | float, NDArray[np.float64] | float]:
    """Radii of the middles of cells and of the faces behind them, in those of the window's middle; elsewhere ones."""
    if not grid.space.hoop:
        return 1.0, 1.0
    middles = corner(window, grid)[0] / grid.cell_size + 0.5 + np.arange(window.shape[0])
    radii = np.maximum(np.stack([middles, middles + 0.5]), 0.0)[..., np.newaxis] / middles.mean()
    return radii[0], radii[1]


def _overfill(volumes: CellVolumes) -> NDArray[np.float64]:
    """V/h^2 - 1 of cells, or what of it obstacles leave; near a free surface only where it is positive."""
    excess = volumes.overfill
    return np.where(volumes.is_interior(), excess, np.maximum(excess, 0.0))


def _faces(volumes: CellVolumes) -> list[NDArray[np.float64]]:
    """One for each face, with the next cell along each axis, that points may move through: no wall, nothing held."""
    is_held = filled_padding(volumes.is_held, volumes.window)
    found = []
    for axis, (below, above) in enumerate(volumes.window.at_walls):
        faces = np.where(is_held | np.roll(is_held, -1, axis), 0.0, 1.0)
        along = np.moveaxis(faces, axis, 0)
        along[0] *= not below
        along[-2] *= not above
        found.append(faces if volumes.room is None else faces * volumes.room.faces[axis])
    return found


def _ways(
    psi: NDArray[np.float64], faces: Sequence[NDArray[np.float64]], window: CellWindow
) -> list[NDArray[np.float64]]:
    """What grad psi moves on the face between each cell and the next along each axis, in cells."""
    continued = filled_padding(psi, window)
    return [(open_faces > 0.0) * (np.roll(continued, -1, axis) - continued) for axis, open_faces in enumerate(faces)]


@register_jitable(forceinline=True)
def _between(values, at):  # type: ignore[no-untyped-def]
    """Interpolate linearly in two axes."""
    i, j = int(at[0]), int(at[1])
    u, v = at[0] - i, at[1] - j
    lower = values[i, j] + v * (values[i, j + 1] - values[i, j])
    upper = values[i + 1, j] + v * (values[i + 1, j + 1] - values[i + 1, j])
    return lower + u * (upper - lower)


@register_jitable(forceinline=True)
def _between_in_3d(values, at):  # type: ignore[no-untyped-def]
    """Interpolate linearly in three axes."""
    i, rest = int(at[0]), (at[1], at[2])
    lower, upper = _between(values[i], rest), _between(values[i + 1], rest)
    return lower + (at[0] - i) * (upper - lower)


@cache
def _make_move(space: Space, precision: str) -> Callable[..., Any]:
    access, axes = position_access(space, precision), space.axes
    along, put_along, mass_of = access.along, access.put_along, access.mass
    between, nowhere = {2: _between, 3: _between_in_3d}[axes], (0.0,) * axes

    @njit(error_model="numpy", cache=True)
    @named(f"{space.name}_{precision}_{CORE_MARK}")
    def move(storage, count, point_mass, lower, cell_size, ways, gravity):  # type: ignore[no-untyped-def]
        """Move points by what the faces around them say; returns the energy that they gained and the longest way."""
        inverse, raised, longest = 1.0 / cell_size, 0.0, 0.0
        for p in range(count):
            at, moved = nowhere, nowhere
            for axis in range(axes):
                # The middle of cell c is at c + 1/2.
                at = replaced(at, axis, (along(storage, axis, p) - lower[axis]) * inverse - 0.5)
            squared, risen = 0.0, 0.0
            for axis in range(axes):
                # The face behind cell c is at c + 1.
                way = between(ways[axis], replaced(at, axis, at[axis] - 0.5))
                moved = replaced(moved, axis, way)
                squared += way * way
                risen -= cell_size * gravity[axis] * way
            for axis in range(axes):
                put_along(storage, axis, p, along(storage, axis, p) + cell_size * moved[axis])
            longest = max(longest, np.sqrt(squared))
            raised += mass_of(storage, p, point_mass) * risen
        return raised, cell_size * longest

    return move
