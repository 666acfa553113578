"""Shapes of bodies, as a scene declares them, and the regular lattice of points that fills one."""

import contextlib
import io
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, model_validator

Points = NDArray[np.float64]
Corner = Annotated[tuple[float, float], Field(strict=False)]


class Shape(BaseModel):
    """A region of the plane."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)

    def bounds(self) -> tuple[Corner, Corner]:
        """Lower and upper corner of the bounding box [m]."""
        raise NotImplementedError

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Which of the points, shape (n, 2) [m], lie inside."""
        raise NotImplementedError


class Rectangle(Shape):
    """An axis-aligned rectangle."""

    kind: Literal["rectangle"]
    lower: Corner = Field(description="lower left corner [m]")
    upper: Corner = Field(description="upper right corner [m]")

    @model_validator(mode="after")
    def _has_area(self) -> "Rectangle":
        if not (self.upper[0] > self.lower[0] and self.upper[1] > self.lower[1]):
            raise ValueError(
                f"upper = {list(self.upper)} must lie above and to the right of lower = {list(self.lower)}"
            )
        return self

    def bounds(self) -> tuple[Corner, Corner]:
        """The rectangle itself."""
        return self.lower, self.upper

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Inside or on the lower and left edges."""
        inside = (points >= np.array(self.lower)) & (points < np.array(self.upper))
        return np.asarray(inside.all(axis=1))


class Disc(Shape):
    """A disc."""

    kind: Literal["disc"]
    center: Corner = Field(description="centre [m]")
    radius: float = Field(gt=0, description="radius [m]")

    def bounds(self) -> tuple[Corner, Corner]:
        """The square around the disc."""
        (x, y), r = self.center, self.radius
        return (x - r, y - r), (x + r, y + r)

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Closer to the centre than the radius."""
        return np.hypot(points[:, 0] - self.center[0], points[:, 1] - self.center[1]) < self.radius


class Polygon(Shape):
    """A simple polygon."""

    kind: Literal["polygon"]
    vertices: list[Corner] = Field(min_length=3, description="corners in order [m]")

    def bounds(self) -> tuple[Corner, Corner]:
        """The box around the corners."""
        corners = np.array(self.vertices)
        return tuple(corners.min(axis=0)), tuple(corners.max(axis=0))

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Inside by the even-odd rule."""
        from matplotlib.path import Path as PlanePath

        return PlanePath(np.array(self.vertices)).contains_points(points)


class MeshRegion(Shape):
    """The region covered by the triangles and quadrilaterals of a mesh file, in any format that meshio reads."""

    kind: Literal["mesh"]
    file: Path = Field(strict=False, description="mesh file; a relative path counts from the scene file")
    _corners: Points = PrivateAttr()
    _cell_finder: Any = PrivateAttr()

    @model_validator(mode="after")
    def _read(self) -> "MeshRegion":
        from matplotlib.tri import Triangulation

        mesh = _read_mesh(self.file)
        cells = mesh.cells_dict
        parts = [cells["triangle"]] if "triangle" in cells else []
        if "quad" in cells:
            parts += [cells["quad"][:, [0, 1, 2]], cells["quad"][:, [0, 2, 3]]]
        if not parts:
            raise ValueError(f"mesh file {self.file} holds no triangles or quadrilaterals")
        triangles = np.concatenate(parts)
        nodes = np.asarray(mesh.points[:, :2], dtype=float)
        self._corners = nodes[np.unique(triangles)]
        try:
            self._cell_finder = Triangulation(nodes[:, 0], nodes[:, 1], triangles).get_trifinder()
        except (RuntimeError, ValueError) as error:
            raise ValueError(f"the cells of mesh file {self.file} overlap or have no area") from error
        return self

    def bounds(self) -> tuple[Corner, Corner]:
        """The box around the nodes that the cells use."""
        return tuple(self._corners.min(axis=0)), tuple(self._corners.max(axis=0))

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Inside any cell."""
        return np.asarray(self._cell_finder(points[:, 0], points[:, 1])) >= 0


def _read_mesh(file: Path) -> Any:
    """The mesh of a file. Raises ValueError in one line: meshio itself prints several and leaves the process."""
    import meshio

    if not file.is_file():
        raise ValueError(f"there is no mesh file {file}")
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            return meshio.read(file)
    except meshio.ReadError as error:
        raise ValueError(f"cannot read mesh file {file}: {error}") from error
    except (Exception, SystemExit) as error:  # meshio raises whatever its parser meets
        raise ValueError(f"cannot read mesh file {file}: it is no valid {file.suffix} file") from error


AnyShape = Annotated[Rectangle | Disc | Polygon | MeshRegion, Field(discriminator="kind")]


def lattice(shape: Shape, origin: Corner, cell_size: float, points_per_cell: int) -> Points:
    """Points at the centres of the sub-squares of the grid's cells whose centre lies in the shape, shape (n, 2) [m].

    Each point stands for the area cell_size^2 / points_per_cell.
    """
    spacing = cell_size / round(points_per_cell**0.5)
    lower, upper = shape.bounds()
    axes = []
    for axis in (0, 1):
        first = int(np.floor((lower[axis] - origin[axis]) / spacing + 1e-6))
        last = int(np.ceil((upper[axis] - origin[axis]) / spacing - 1e-6))
        axes.append(origin[axis] + (np.arange(first, last) + 0.5) * spacing)
    x, y = np.meshgrid(*axes, indexing="ij")
    candidates = np.column_stack([x.ravel(), y.ravel()])
    return candidates[shape.contains(candidates)]
