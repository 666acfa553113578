"""Triangles in space: their nodes, areas and volume, and those around tetrahedra."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.scene.outline import Points

# Of the size of a mesh: corners closer than this are one node.
SAME_NODE = 1e-6
# Of the cube of the size of a mesh.
SMALLEST_VOLUME = 1e-12


class Distinct(NamedTuple):
    """The distinct rows of an array, by their first occurrence; which of them each row is; how often each occurs."""

    first: NDArray[np.int64]
    which: NDArray[np.int64]
    uses: NDArray[np.int64]


def distinct(rows: NDArray[Any]) -> Distinct:
    """The distinct rows of an array, shape (n, columns); ten times as fast as `numpy.unique`."""
    order = np.lexsort(rows.T)
    ordered = rows[order]
    is_new = np.ones(len(rows), bool)
    is_new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    which = np.empty(len(rows), np.int64)
    which[order] = np.cumsum(is_new) - 1
    return Distinct(order[is_new], which, np.bincount(which))


def node_numbers(cells: Points) -> NDArray[np.int64]:
    """Numbers of the corners of cells, shape (cells, corners); `cells` has the shape (cells, corners, 3) [m]."""
    corners = cells.reshape(-1, 3)
    node = SAME_NODE * max(float(np.ptp(corners, axis=0).max()), np.finfo(float).tiny)
    return distinct(np.round((corners - corners.min(axis=0)) / node)).which.reshape(cells.shape[:2])


def areas_in_space(triangles: Points) -> NDArray[np.float64]:
    """The areas of triangles, shape (m, 3, 3) [m], in m2."""
    along = triangles[:, 1:] - triangles[:, :1]
    return np.asarray(0.5 * np.linalg.norm(np.cross(along[:, 0], along[:, 1]), axis=1))


def encloses_volume(triangles: Points) -> bool:
    """Whether a closed surface of triangles, shape (m, 3, 3) [m], is more than a sheet."""
    corners = triangles.reshape(-1, 3)
    size = float(np.ptp(corners, axis=0).max())
    volume = float(np.linalg.det(triangles - corners.mean(axis=0)).sum()) / 6.0
    return abs(volume) > SMALLEST_VOLUME * size**3


def outer_faces(tetrahedra: Points, source: str) -> Points:
    """The faces that belong to one tetrahedron only, facing outwards, shape (m, 3, 3) [m].

    `tetrahedra` are corners, shape (n, 4, 3) [m]. Raises ValueError if one has no volume or if three share a face.
    """
    volumes = np.linalg.det(tetrahedra[:, 1:] - tetrahedra[:, :1])
    if not volumes.all():
        raise ValueError(f"{source} has a tetrahedron without a volume")
    turned = np.where((volumes > 0.0)[:, None, None], tetrahedra, tetrahedra[:, [0, 2, 1, 3]])
    faces = turned[:, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]].reshape(-1, 3, 3)
    found = distinct(np.sort(node_numbers(faces), axis=1))
    if found.uses.max() > 2:
        raise ValueError(f"the tetrahedra of {source} overlap: three share a face")
    return faces[found.first[found.uses == 1]]
