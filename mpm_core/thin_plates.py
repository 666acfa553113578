"""Obstacles too thin for the grid: material on their two sides shares nodes, and each side drags the other along."""

import warnings
from collections.abc import Sequence

import numpy as np
import scipy
from numpy.typing import NDArray

from grainlaw.materials.errors import InputWarning
from grainlaw.mpm_core.body import Body
from grainlaw.mpm_core.obstacles.contact import distances
from grainlaw.mpm_core.obstacles.obstacle import Obstacle

Floats = NDArray[np.float64]

# Cells that an obstacle has to be thick for the stencils of points at its two sides not to meet.
THICK = 3.0
# Cells from a surface within which a point is at it.
NEAR = 1.0
# Cosine between the normals at two points that are on two sides.
OPPOSED = -0.5
# Step of the differences that normals are made from [cells].
STEP = 1e-3


class ThinPlates:
    """The thin obstacles of a run; of each, material on both sides is told once."""

    def __init__(self, obstacles: Sequence[Obstacle], cell_size: float) -> None:
        self.cell_size = cell_size
        self._watched = [
            obstacle for obstacle in obstacles if not obstacle.hollow and obstacle.surface.thickness < THICK * cell_size
        ]

    def parting(self, bodies: Sequence[Body]) -> list[Obstacle]:
        """Those that have material on both sides."""
        return [obstacle for obstacle in self._watched if self._parts(obstacle, bodies)]

    def described(self, obstacle: Obstacle) -> str:
        """How thin an obstacle is."""
        thickness = obstacle.surface.thickness
        return f"'{obstacle.name}' is {thickness:g} m thick, {thickness / self.cell_size:.2g} cells"

    def what_would_do(self, obstacle: Obstacle) -> str:
        """The thickness, or the cells, with which its two sides are apart."""
        finer = obstacle.surface.thickness / THICK
        return f"{THICK * self.cell_size:g} m or more, or cells of {finer:.3g} m or less"

    def look(self, time: float, obstacles: Sequence[Obstacle], bodies: Sequence[Body]) -> None:
        """Warn, as InputWarning, about those still there that material has come to both sides of by a time [s]."""
        self._watched = [obstacle for obstacle in self._watched if obstacle in obstacles]
        for obstacle in self.parting(bodies):
            self._watched.remove(obstacle)
            warnings.warn(
                f"t = {time:.6g} s: material has come to both sides of an obstacle, shares nodes and is dragged along: "
                f"{self.described(obstacle)}; what would do: {self.what_would_do(obstacle)}",
                InputWarning,
                stacklevel=2,
            )

    def _parts(self, obstacle: Obstacle, bodies: Sequence[Body]) -> bool:
        near = [np.empty((0, 0))]
        for body in bodies:
            is_near = distances(obstacle, body.positions) < NEAR * self.cell_size
            near.append(np.asarray(body.positions[:, is_near], np.float64).T)
        places = np.concatenate([found for found in near if len(found)] or [np.empty((0, 2))])
        if len(places) < 2:
            return False
        _, one_in_each_cell = np.unique(np.floor(places / self.cell_size), axis=0, return_index=True)
        places = places[one_in_each_cell]
        normals = self._normals(obstacle, places)
        beyond = places - THICK * self.cell_size * normals
        is_thin = distances(obstacle, np.ascontiguousarray(beyond.T)) > 0.0
        places, normals = places[is_thin], normals[is_thin]
        one, other = scipy.spatial.cKDTree(places).query_pairs(THICK * self.cell_size, output_type="ndarray").T
        return bool(((normals[one] * normals[other]).sum(axis=1) < OPPOSED).any())

    def _normals(self, obstacle: Obstacle, places: Floats) -> Floats:
        step = STEP * self.cell_size
        shifts = step * np.eye(places.shape[1])
        normals = np.column_stack(
            [distances(obstacle, (places + shift).T) - distances(obstacle, (places - shift).T) for shift in shifts]
        )
        return np.asarray(normals / (2.0 * step))
