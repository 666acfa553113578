"""Terrain: ground below a line of points, or below heights on a grid."""

from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from grainlaw.mpm_core.scene.heights import Heights, read_heights
from grainlaw.mpm_core.scene.outline import Points
from grainlaw.mpm_core.scene.section import Section
from grainlaw.mpm_core.scene.shapes import Corner


class Terrain(Section):
    """Ground below a line of points, beyond whose ends it goes on level; in 3D below heights from a file."""

    kind: Literal["terrain"]
    points: list[Corner] | None = Field(
        default=None, min_length=2, description="points of the surface, x increasing [m]; not in 3D"
    )
    file: Path | None = Field(
        default=None,
        strict=False,
        description="in 3D heights on square cells: ESRI ASCII grid (.asc), CSV with columns x, y, z, NumPy (.npy, "
        "along x and y) or GeoTIFF (.tif, with rasterio installed); else CSV with columns x, y. A relative path "
        "counts from the scene file",
    )
    lower: Annotated[tuple[float, float], Field(strict=False)] | None = Field(
        default=None, description="place of the first height along x and y [m]; default: what the file says"
    )
    spacing: float | None = Field(default=None, gt=0, description="between neighbouring heights of a .npy file [m]")
    _heights: Heights | None = PrivateAttr(default=None)
    _line: list[Corner] | None = PrivateAttr(default=None)

    def read_for(self, axes: int) -> None:
        """Read the file, as the axes of the space ask for it. Raises ValueError for what does not belong together."""
        if axes == 3:
            if self.file is None or self.points is not None:
                raise ValueError("terrain in 3D takes a file of heights, and no points")
            self._heights = read_heights(self.file, self.lower, self.spacing)
            return
        if (self.points is None) == (self.file is None) or self.lower is not None or self.spacing is not None:
            raise ValueError("terrain takes points, or a file with columns x, y; lower and spacing belong to 3D")
        if self.file is not None:
            self._line = _line_of(self.file)
            _refuse_backwards(self._line, f"file {self.file}")

    @model_validator(mode="after")
    def _runs_to_the_right(self) -> "Terrain":
        _refuse_backwards(self.points or [], "points")
        return self

    @property
    def heights(self) -> Heights:
        """The heights of terrain in 3D."""
        if self._heights is None:
            raise ValueError("terrain without a file has no heights")
        return self._heights

    @property
    def line(self) -> list[Corner]:
        """The points of terrain in two axes [m]."""
        return self.points or self._line or []

    def outline(self, left: float, right: float, bottom: float) -> Points:
        """The corners of the ground between two places and down to a third [m], shape (n, 2)."""
        (first, start), (last, end) = self.line[0], self.line[-1]
        left, right = min(left, first), max(right, last)
        before = [(left, start)] if left < first else []
        behind = [(right, end)] if right > last else []
        return np.array([(left, bottom), *before, *self.line, *behind, (right, bottom)])


def _refuse_backwards(line: list[Corner], where: str) -> None:
    for (x, _), (further, _) in pairwise(line):
        if not further > x:
            raise ValueError(f"{where}: x goes from {x:g} to {further:g}; allowed: increasing x")


def _line_of(file: Path) -> list[Corner]:
    try:
        table: Any = np.genfromtxt(file, delimiter=",", names=True, dtype=np.float64, encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        raise ValueError(f"file {file} cannot be read: {error}") from error
    if not {"x", "y"} <= set(table.dtype.names or ()) or table.ndim != 1 or len(table) < 2:
        raise ValueError(f"file {file} needs two rows or more with the columns x, y")
    for row, place in enumerate(zip(table["x"].tolist(), table["y"].tolist(), strict=True), start=2):
        if not all(map(np.isfinite, place)):
            raise ValueError(f"file {file}, line {row}: a value is missing or is no number")
    return list(zip(table["x"].tolist(), table["y"].tolist(), strict=True))
