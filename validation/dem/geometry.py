"""Where a column stands before its release: its walls, its floor and its box; plane or a cylinder."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from grainlaw.validation.dem.description import Collapse, CylinderCollapse
from grainlaw.validation.dem.packing import Array, Packing, glued_layer, loose, repeated

# Space below the floor and beyond its ends [m].
MARGIN = 0.05
# Side of the periodic square of glued grains that covers a round floor, in mean diameters.
TILE = 20.0

Column = Collapse | CylinderCollapse


@dataclass(frozen=True)
class Geometry:
    """What the decks and the record of a run need to know.

    base           area on which the column stands [m2]
    ends           of the box along x and y (2, 2) [m]
    column         space of the column along x and y (2, 2) [m]
    walls          the smooth walls that vanish, as LIGGGHTS' primitives
    record         what `run.json` says of it
    radius         of the round wall around x = y = 0 [m], if there is one
    is_periodic    along y
    """

    base: float
    ends: Array
    column: Array
    walls: tuple[str, ...]
    record: dict[str, Any]
    radius: float = np.inf
    is_periodic: bool = False

    @property
    def with_contacts(self) -> bool:
        """Whether the contacts are written, for stress: of a plane column alone."""
        return self.is_periodic

    @property
    def boundary(self) -> str:
        """Of the box along x, y, z, in the words of LIGGGHTS."""
        return "f p f" if self.is_periodic else "f f f"

    def box(self, top: float) -> Array:
        """The box (3, 2) of a run up to a level [m]."""
        return np.vstack([self.ends, [-MARGIN, top]])

    def loose_grains(self, radii: Array, low: float, top: float, random: np.random.Generator) -> Packing:
        """Grains of these radii [m] within the walls between two levels [m], apart from one another."""
        space = np.vstack([self.column, [low, top]])
        return loose(radii, space, (False, self.is_periodic, False), random, self.radius)


def geometry_of(case: Column) -> Geometry:
    """The geometry of a case."""
    return _cylinder(case) if isinstance(case, CylinderCollapse) else _plane(case)


def glued_grains(case: Column, random: np.random.Generator) -> Packing:
    """A layer of grains at z = 0 that covers the floor of a case."""
    if isinstance(case, Collapse):
        return glued_layer(case.grains, (-case.reach, case.reach), (0.0, case.depth), False, random)
    side = TILE * case.grains.mean_diameter
    return repeated(glued_layer(case.grains, (0.0, side), (0.0, side), True, random), side, case.reach)


def _plane(case: Collapse) -> Geometry:
    end = case.reach + MARGIN
    across = [0.0, case.depth]
    return Geometry(
        base=2.0 * case.half_width * case.depth,
        ends=np.array([[-end, end], across]),
        column=np.array([[-case.half_width, case.half_width], across]),
        walls=(f"xplane {-case.half_width}", f"xplane {case.half_width}"),
        record={
            "half_width": case.half_width,
            "depth": case.depth,
            "box": [[-case.reach, case.reach], across, [0.0, None]],
            "periodic": [False, True, False],
        },
        is_periodic=True,
    )


def _cylinder(case: CylinderCollapse) -> Geometry:
    end, radius = case.reach + MARGIN, case.radius
    return Geometry(
        base=float(np.pi * radius**2),
        ends=np.array([[-end, end], [-end, end]]),
        column=np.array([[-radius, radius], [-radius, radius]]),
        walls=(f"zcylinder {radius} 0. 0.",),
        record={"space": "axisymmetric", "axis": [0.0, 0.0], "half_width": radius},
        radius=radius,
    )
