"""What a picture shows of a run: a frame in a plane, with the obstacles that are there at its time."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage
from numpy.typing import NDArray

from grainlaw.mpm_core.output.cut import Cut, cuts_of, domain_of
from grainlaw.mpm_core.output.frame import Frame
from grainlaw.mpm_core.output.materials_of_points import Materials
from grainlaw.mpm_core.output.obstacle_drawing import boxes_within, draw_obstacles
from grainlaw.mpm_core.output.obstacle_series import obstacles_at
from grainlaw.mpm_core.output.picture_style import scalar_values
from grainlaw.mpm_core.output.point_image import Box, ColorScale, bounding_box, draw_points, point_spacing
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.vtp import ObstacleFrame


@dataclass(frozen=True)
class Section:
    """A frame as it is shown in a plane.

    spacing    of the points when they were generated [m]
    groups     the number of the material of each point, shape (points,); None where there is one
    obstacles  those of the frame's time
    domain     the two corners of the domain, shape (2, axes) [m]; None where there is no obstacle
    """

    frame: Frame
    spacing: float
    groups: NDArray[np.int64] | None
    cut: Cut
    obstacles: Sequence[ObstacleFrame] = ()
    domain: NDArray[np.float64] | None = None

    @property
    def boxes(self) -> list[Box]:
        """The bounding boxes of what is shown [m]; none where all points have left."""
        points = self.frame.positions
        of_points = [bounding_box(points, self.spacing, self.cut)] if len(points) else []
        return [*of_points, *boxes_within(self.obstacles, self.domain, self.cut)]

    def draw(self, axes: Axes, field: str, scale: ColorScale, box: Box, pixel: float | None = None) -> AxesImage:
        """Draw points and obstacles as a box [m] shows them; `pixel` [m] is that of `draw_points`.

        Raises InputError if the frame does not hold the field.
        """
        values = scalar_values(self.frame.field(field))
        image = draw_points(axes, self.frame.positions, values, self.spacing, scale, self.groups, self.cut, pixel)
        draw_obstacles(axes, self.obstacles, self.cut, box)
        return image


@dataclass(frozen=True)
class ShownRun:
    """A run as pictures show it. Raises InputError, on access, for frames or parts of the scene that are missing."""

    run: RunFolder
    materials: Materials

    @cached_property
    def spacing(self) -> float:
        """That of the points when they were generated [m]."""
        return point_spacing(self.run.load_frame(self.run.first_with_points).positions)

    @cached_property
    def cuts(self) -> tuple[Cut, ...]:
        """The planes that are shown, the first one alone where there is room for one."""
        return cuts_of(self.run)

    @cached_property
    def domain(self) -> NDArray[np.float64]:
        """The two corners of the domain, shape (2, axes) [m]."""
        return domain_of(self.run)

    def section(self, frame: Frame) -> Section:
        """A frame of the run in the first plane."""
        obstacles = obstacles_at(self.run.path, frame.time)
        domain = self.domain if obstacles else None
        return Section(frame, self.spacing, self.materials.of_points(frame), self.cuts[0], obstacles, domain)
