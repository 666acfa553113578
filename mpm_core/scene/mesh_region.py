"""The region of a mesh file: cells of the plane or, in 3D, a closed surface or tetrahedra."""

from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr, model_validator

from grainlaw.mpm_core.scene.mesh_file import read_cells
from grainlaw.mpm_core.scene.outline import Points, areas, closed_edges, enclosed, enclosed_area, outer_edges
from grainlaw.mpm_core.scene.shape import Shape
from grainlaw.mpm_core.scene.surface import Surface, closed_surface
from grainlaw.mpm_core.scene.triangles import outer_faces

SAME_AREA = 1e-6  # relative; interface nodes of two parts may differ by the digits of the file


class PlaneRegion(NamedTuple):
    """A region of the plane by its edges (`outline.outer_edges`)."""

    outline: Points

    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The box around the edges."""
        corners = self.outline.reshape(-1, 2)
        return tuple(corners.min(axis=0)), tuple(corners.max(axis=0))

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Inside any cell, or on the lower and left edges of the region."""
        return enclosed(points, self.outline)


class MeshRegion(Shape):
    """What a mesh file covers, in any format that meshio reads, or STL, OBJ, PLY, OFF.

    In the x-y plane triangles and quadrilaterals; in 3D tetrahedra, or the inside of a closed surface.
    """

    kind: Literal["mesh"]
    file: Path = Field(strict=False, description="mesh file; a relative path counts from the scene file")
    group: str | None = Field(default=None, description="physical group of a gmsh file")
    _region: PlaneRegion | Surface = PrivateAttr()

    @model_validator(mode="after")
    def _read(self) -> "MeshRegion":
        source = f"mesh file {self.file}"
        cells = read_cells(self.file, self.group)
        if cells.are_solid:
            corners = np.concatenate([block[:, :4] for block in cells.blocks])
            self._region = closed_surface(outer_faces(corners, source), source)
        elif cells.blocks[0].shape[2] == 3:
            self._region = closed_surface(np.concatenate([_triangles(block) for block in cells.blocks]), source)
        else:
            self._region = _plane_region(cells.blocks, source)
        return self

    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The box around the region."""
        return self._region.bounds()

    def triangles(self) -> Points:
        """The triangles of the surface of a region in 3D, shape (m, 3, 3) [m]; none of one in the plane."""
        return self._region.triangles if isinstance(self._region, Surface) else np.empty((0, 3, 3))

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Inside, or on the lower, left and front sides of the region."""
        return self._region.contains(points)


def _triangles(outlines: Points) -> Points:
    """The triangles from the first node of outlines to their edges, shape (m, 3, 3)."""
    corners = range(1, outlines.shape[1] - 1)
    return np.concatenate([outlines[:, [0, corner, corner + 1]] for corner in corners])


def _plane_region(blocks: list[Points], source: str) -> PlaneRegion:
    outline = outer_edges(np.concatenate([closed_edges(block) for block in blocks]))
    sizes = np.concatenate([areas(block) for block in blocks])
    twice = sizes.sum() - enclosed_area(outline)
    if not (sizes.min() > 0 and twice <= min(SAME_AREA * sizes.sum(), 0.5 * sizes.min())):
        raise ValueError(f"the cells of {source} overlap or have no area")
    return PlaneRegion(outline)
