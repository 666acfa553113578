"""What a shape of a body tells of itself."""

import numpy as np
from numpy.typing import NDArray

from grainlaw.mpm_core.scene.outline import Points
from grainlaw.mpm_core.scene.section import Section


class Shape(Section):
    """A region of the plane or of space."""

    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Lower and upper corner of the bounding box [m]."""
        raise NotImplementedError

    def contains(self, points: Points) -> NDArray[np.bool_]:
        """Which of the points, shape (n, axes) [m], lie inside."""
        raise NotImplementedError
