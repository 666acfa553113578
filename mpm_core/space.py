"""The spaces that a scene can live in: plane strain, axisymmetry, three dimensions.

Plane strain       x right, y up; nothing changes along z. Amounts are per width.
Axisymmetry        x is the radius, y up; nothing changes around the axis x = 0, the left side. Amounts are per radian.
Three dimensions   x right, y back, z up. Amounts are those of the whole body.
"""

from dataclasses import dataclass

# The names of the sides of a domain along each axis, the lower one first.
_SIDES_2D = (("left", "right"), ("bottom", "top"))
_SIDES_3D = (("left", "right"), ("front", "back"), ("bottom", "top"))


@dataclass(frozen=True)
class Space:
    """A space: how many axes its grid has, and whether material is stretched around an axis (`hoop`).

    `amount` says what masses and energies are per, for units: "/m", "/rad" or nothing.
    """

    name: str
    axes: int
    hoop: bool
    amount: str

    @property
    def up(self) -> int:
        """The vertical axis, the last."""
        return self.axes - 1

    @property
    def axis_names(self) -> tuple[str, ...]:
        """The names of the coordinates."""
        return ("x", "y", "z")[: self.axes]

    @property
    def sides(self) -> tuple[tuple[str, str], ...]:
        """The names of the sides along each axis, the lower one first."""
        return _SIDES_3D if self.axes == 3 else _SIDES_2D


PLANE_STRAIN = Space("plane_strain", 2, hoop=False, amount="/m")
AXISYMMETRIC = Space("axisymmetric", 2, hoop=True, amount="/rad")
THREE_D = Space("3d", 3, hoop=False, amount="")
SPACES = {space.name: space for space in (PLANE_STRAIN, AXISYMMETRIC, THREE_D)}
