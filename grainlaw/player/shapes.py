"""The obstacles of a run as the page draws them: each outline once, however many frames show it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.output.cut import Cut
from grainlaw.mpm_core.output.obstacle_drawing import loops_of
from grainlaw.mpm_core.output.vtp import ObstacleFrame
from grainlaw.player.packing import as_text

# Edges between triangles that meet at a smaller angle are not drawn.
_SHARP = np.cos(np.radians(30.0))
# Of a coordinate in text.
_DIGITS = 5


class Shapes:
    """Outlines of obstacles, and which of them each frame shows; `size` is about what they take [bytes]."""

    def __init__(self, cut: Cut) -> None:
        self.cut = cut
        self.size = 0
        self.of_frames: list[list[int]] = []
        self._outlines = _Pool()
        self._solids = _Pool()

    def add(self, obstacles: Sequence[ObstacleFrame], *, in_3d: bool) -> None:
        """Add those of the next frame."""
        self.of_frames.append([self._number(obstacle, in_3d) for obstacle in obstacles if obstacle.outline.faces])

    def content(self, frames: Sequence[int]) -> dict[str, Any]:
        """All outlines, and the numbers of those that the frames of these numbers show."""
        shown = [self.of_frames[index] if self.of_frames else [] for index in frames]
        return {"outlines": self._outlines.content, "solids": self._solids.content, "frames": shown}

    def _number(self, obstacle: ObstacleFrame, in_3d: bool) -> int:
        points = obstacle.outline.points.astype(np.float32)
        key = (obstacle.hollow, points.tobytes())
        if (found := self._outlines.find(key)) is not None:
            return found
        content: dict[str, Any] = {"isHollow": obstacle.hollow}
        if in_3d:
            content |= {"points": as_text(points), "solid": self._solid(obstacle)}
            self.size += points.nbytes
        else:
            loops = loops_of(obstacle.outline, self.cut)
            content["loops"] = [[float(f"{number:.{_DIGITS}g}") for number in loop.ravel()] for loop in loops]
            # As text a number takes about as much as its bytes would.
            self.size += 8 * sum(loop.size for loop in loops)
        return self._outlines.add(key, content)

    def _solid(self, obstacle: ObstacleFrame) -> int:
        """The number of the triangles and sharp edges, which an obstacle keeps while it moves."""
        faces = np.array(obstacle.outline.faces, np.uint32)
        key = faces.tobytes()
        if (found := self._solids.find(key)) is not None:
            return found
        edges = _sharp_edges(obstacle.outline.points, faces)
        self.size += faces.nbytes + edges.nbytes
        return self._solids.add(key, {"faces": as_text(faces), "edges": as_text(edges)})


class _Pool:
    """Contents by what they were made from."""

    def __init__(self) -> None:
        self.content: list[dict[str, Any]] = []
        self._numbers: dict[Any, int] = {}

    def find(self, key: Any) -> int | None:
        return self._numbers.get(key)

    def add(self, key: Any, content: dict[str, Any]) -> int:
        self._numbers[key] = len(self.content)
        self.content.append(content)
        return self._numbers[key]


def _sharp_edges(points: NDArray[np.float64], faces: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """The numbers of the corners of edges where a surface has a kink or ends, shape (n, 2)."""
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, place, counts = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    # The sum of the normals of two faces is as long as twice the cosine of half their angle.
    sums = np.zeros((len(unique), 3))
    np.add.at(sums, place.ravel(), np.tile(normals, (3, 1)))
    between = 0.5 * (sums**2).sum(axis=1) - 1.0
    return np.asarray(unique[(counts != 2) | (between < _SHARP)], np.uint32)
