"""The room that obstacles leave: of each cell, as volumes of points are deposited there, and of each face.

Cells that a surface cuts are looked at in `PARTS` parts along each axis, and count with the weights with which volumes
are deposited (`cell_volumes`). The open share of a face is that of a plane surface at the distance of its middle.
"""

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.grid.cell_volumes import CellWindow, Room
from grainlaw.mpm_core.grid.grid import Grid
from grainlaw.mpm_core.obstacles.contact import distances
from grainlaw.mpm_core.obstacles.obstacle import Obstacle

Floats = NDArray[np.float64]

PARTS = 4
# What a uniformly filled cell brings to the cell before, to itself and to the one behind: integrals of the B-spline.
SMEARED = (1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0)


class _Whole(NamedTuple):
    """The room of all cells of the grid with a layer of padding, and the open shares of the faces behind them."""

    cells: Floats
    faces: list[Floats]


class FreeRoom:
    """The free room of a grid, found again when an obstacle has moved or was taken away."""

    def __init__(self, grid: Grid, periodic_axes: Sequence[int]) -> None:
        self.grid = grid
        self.periodic_axes = periodic_axes
        self._poses: tuple[bytes, ...] | None = None
        self._whole: _Whole

    def of_window(self, obstacles: Sequence[Obstacle], window: CellWindow) -> Room | None:
        """The room of the cells of a window, and the faces behind them; None without obstacles."""
        if not obstacles:
            return None
        poses = tuple(
            obstacle.name.encode() + obstacle.motion.pose.position.tobytes() + obstacle.motion.pose.rotation.tobytes()
            for obstacle in obstacles
        )
        if poses != self._poses:
            self._poses, self._whole = poses, self._found(obstacles)
        part = tuple(
            slice(first + 1, first + 1 + cells) for first, cells in zip(window.first, window.shape, strict=True)
        )
        return Room(self._whole.cells[part], [faces[part] for faces in self._whole.faces])

    def _found(self, obstacles: Sequence[Obstacle]) -> _Whole:
        size = self.grid.cell_size
        middles: list[Floats] = [
            low + size * (np.arange(-1, cells + 1, dtype=np.float64) + 0.5)
            for low, cells in zip(self.grid.lower, self.grid.cells, strict=True)
        ]
        shape = tuple(map(len, middles))
        nearest = _nearest(obstacles, np.stack(np.meshgrid(*middles, indexing="ij")).reshape(len(shape), -1))
        half_diagonal = 0.5 * size * len(shape) ** 0.5
        cells = self._smeared((nearest > half_diagonal).astype(np.float64).reshape(shape))
        cut = np.flatnonzero(np.abs(nearest) <= half_diagonal)
        self._add_cut(cells, cut, middles, obstacles)
        faces = []
        for axis in range(len(shape)):
            behind = [along + 0.5 * size * (k == axis) for k, along in enumerate(middles)]
            places = np.stack(np.meshgrid(*behind, indexing="ij")).reshape(len(shape), -1)
            faces.append(np.clip(0.5 + _nearest(obstacles, places) / size, 0.0, 1.0).reshape(shape))
        return _Whole(cells, faces)

    def _smeared(self, cells: Floats) -> Floats:
        for axis in range(cells.ndim):
            along = np.moveaxis(cells, axis, 0)
            is_periodic = axis in self.periodic_axes
            along[0], along[-1] = (along[-2], along[1]) if is_periodic else (along[1], along[-2])
            before, behind = np.roll(along, 1, 0), np.roll(along, -1, 0)
            spread = SMEARED[1] * along + SMEARED[0] * before + SMEARED[2] * behind
            cells = np.moveaxis(spread, 0, axis).copy()
        return cells

    def _add_cut(
        self, cells: Floats, cut: NDArray[np.int64], middles: Sequence[Floats], obstacles: Sequence[Obstacle]
    ) -> None:
        """Add the parts of cut cells that are free to the cells around them; beyond walls there is nothing to add."""
        axes = cells.ndim
        number = np.stack(np.unravel_index(cut, cells.shape))
        on_grid = np.all([(n > 0) & (n < count - 1) for n, count in zip(number, cells.shape, strict=True)], axis=0)
        number = number[:, on_grid]
        centers = np.stack([along[n] for along, n in zip(middles, number, strict=True)])
        offsets = (np.arange(PARTS) + 0.5) / PARTS - 0.5
        for part in product(offsets, repeat=axes):
            shift = np.array(part)[:, np.newaxis]
            free = _nearest(obstacles, centers + self.grid.cell_size * shift) > 0.0
            weights = [_weights(offset) for offset in part]
            for way in product((-1, 0, 1), repeat=axes):
                share = float(np.prod([weights[axis][way[axis] + 1] for axis in range(axes)])) / PARTS**axes
                target = tuple(self._inside(number[axis, free] + way[axis], axis) for axis in range(axes))
                np.add.at(cells, target, share)

    def _inside(self, numbers: NDArray[np.int64], axis: int) -> NDArray[np.int64]:
        """Cells in place of those in the padding: mirror images beyond walls, the other end along a periodic axis."""
        last = self.grid.cells[axis]
        if axis in self.periodic_axes:
            return (numbers - 1) % last + 1
        return np.clip(numbers, 1, last)


def _nearest(obstacles: Sequence[Obstacle], places: Floats) -> Floats:
    """The distance of places, shape (axes, n), from the nearest obstacle [m]."""
    return np.min([distances(obstacle, places) for obstacle in obstacles], axis=0)


def _weights(offset: float) -> tuple[float, float, float]:
    """Quadratic B-spline of a place at an offset from the middle of its cell, for that cell and its neighbours."""
    return 0.5 * (0.5 - offset) ** 2, 0.75 - offset**2, 0.5 * (0.5 + offset) ** 2
