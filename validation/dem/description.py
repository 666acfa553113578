"""What a DEM case is: grains, contact law, geometry, seeds and output times, said once for both codes."""

import math
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Positive = Annotated[float, Field(gt=0)]
Floor = Literal["glued", "flat"]
# A grain alone on a plane slows by 0.7 m/s2 only and rolls on when the pile has come to rest.
ROLLING_REACH = 4.0


class Described(BaseModel):
    """A part of a case: immutable, and refusing keys that it does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Grains(Described):
    """Spheres with diameters uniform between two values [m] and one density [kg/m3]."""

    smallest_diameter: Positive = 0.012
    largest_diameter: Positive = 0.018
    density: Positive = 2450.0

    @property
    def mean_diameter(self) -> float:
        """Number mean of the diameter [m]."""
        return 0.5 * (self.smallest_diameter + self.largest_diameter)


class Contact(Described):
    """Hertz-Mindlin contact with tangential history and an elastic-plastic rolling resistance.

    `rolling_arm` is the arm of the largest rolling moment over the normal force, in grain radii.
    """

    youngs_modulus: Positive = 1e8
    poissons_ratio: Annotated[float, Field(ge=0, lt=0.5)] = 0.3
    restitution: Annotated[float, Field(gt=0, le=1)] = 0.5
    friction: Annotated[float, Field(ge=0)] = 0.7
    rolling_arm: Annotated[float, Field(ge=0)] = 0.1


class Case(Described):
    """What every kind of case has; the seeds say which packings each code runs by default."""

    name: str
    purpose: str
    grains: Grains = Grains()
    contact: Contact = Contact()
    time_step: Positive = 3e-5
    liggghts_seeds: tuple[int, ...]
    yade_seeds: tuple[int, ...] = ()

    def seeds(self, code: str) -> tuple[int, ...]:
        """The packings that a code runs by default."""
        return self.liggghts_seeds if code == "liggghts" else self.yade_seeds


class Release(Case):
    """A column that is released at t = 0 on a floor.

    The packing settles under gravity with low friction between smooth walls, is cut at the initial height (grains whose
    centre lies above are taken out), relaxes with the full friction, and the walls vanish.
    """

    aspect_ratio: Positive
    floor: Floor
    gravity: Positive = 9.81
    end: Positive
    output_interval: Positive = 0.05
    relaxation: Positive = 0.15


class Collapse(Release):
    """A column between two walls, released to both sides; plane in the mean, periodic over `depth`."""

    kind: Literal["collapse"] = "collapse"
    half_width: Positive = 0.15
    depth: Positive = 0.06

    @property
    def initial_height(self) -> float:
        """Height of the column [m]: aspect ratio times half width."""
        return self.aspect_ratio * self.half_width

    @property
    def reach(self) -> float:
        """Half length of the floor [m], well beyond the runout of the pile and, on a flat floor, of single grains."""
        return _with_rolling(self, self.half_width * (2.0 + 3.5 * float(self.aspect_ratio) ** 0.75))


class CylinderCollapse(Release):
    """A cylinder of grains, in a wall of its radius, released to all sides."""

    kind: Literal["cylinder"] = "cylinder"
    radius: Positive = 0.225

    @property
    def initial_height(self) -> float:
        """Height of the cylinder [m]: aspect ratio times radius."""
        return self.aspect_ratio * self.radius

    @property
    def reach(self) -> float:
        """Radius of the floor [m], well beyond the runout of the pile (1.25 a radii) and of single grains."""
        return _with_rolling(self, self.radius * (2.0 + 1.8 * self.aspect_ratio))


def _with_rolling(case: Release, pile: float) -> float:
    return ROLLING_REACH * pile if case.floor == "flat" else pile


class ShearStage(Described):
    """One speed of the wall, and the strains of its transient and of its average.

    The nominal inertial number is that of the wall's speed over the nominal height; the grains dilate and slip along
    the wall, so that the bulk's own number, which is measured, is 0.7 of it in slow flow and a third in the fastest.
    """

    nominal_inertial_number: Positive
    transient_strain: Positive
    average_strain: Positive


class ShearCell(Case):
    """Plane shear without gravity between two rough walls of glued grains, periodic along and across.

    The lower wall stands; the upper one moves at a fixed speed and is free to rise, under a fixed normal stress.
    """

    length: Positive = 0.18
    depth: Positive = 0.09
    height: Positive = 0.21
    normal_stress: Positive = 5000.0


class SteadyShear(ShearCell):
    """Steady shear at several speeds, one after the other."""

    stages: tuple[ShearStage, ...]


class PlaneShear(SteadyShear):
    """Between two rough walls."""

    kind: Literal["shear"] = "shear"


class WallShear(SteadyShear):
    """Over a flat plane in place of the lower wall, with the friction of the contacts."""

    kind: Literal["wall-shear"] = "wall-shear"


class ShearStep(Described):
    """A speed of the wall, backwards if negative, for a nominal strain, of which blocks are averaged."""

    nominal_inertial_number: float
    strain: Positive
    block_strain: Positive


class ShearSteps(ShearCell):
    """Shear of a packing at one speed of the wall after the other, followed over its strain.

    The packing is pressed together with `packing_friction`, which makes it dense or loose, rests, and is sheared with
    the full friction.
    """

    kind: Literal["shear-steps"] = "shear-steps"
    packing_friction: Annotated[float, Field(ge=0)] = 0.1
    resting_time: Positive = 1.2
    steps: tuple[ShearStep, ...]


class Compression(Case):
    """Isotropic compression of a periodic cube from a loose state to `largest_pressure`, and unloading.

    The strain rate of the cube [1/s] is that of `loading_rate` once the pressure has passed `start_pressure`.
    """

    kind: Literal["compression"] = "compression"
    side: Positive = 0.15
    start_pressure: Positive = 200.0
    largest_pressure: Positive = 2e5
    loading_rate: Positive = 0.02
    gas_fraction: Annotated[float, Field(gt=0, lt=0.4)] = 0.3


class Triaxial(Case):
    """Drained triaxial compression of a periodic cube: lateral stress held, axial strain at a rate [1/s].

    The packing is pressed together with `packing_friction` and rests under the lateral stress on all sides.
    """

    kind: Literal["triaxial"] = "triaxial"
    side: Positive = 0.15
    lateral_stress: Positive = 5000.0
    packing_friction: Annotated[float, Field(ge=0)] = 0.1
    axial_rate: Positive = 0.1
    final_strain: Positive = 0.2
    resting_time: Positive = 0.3
    gas_fraction: Annotated[float, Field(gt=0, lt=0.4)] = 0.3


class SlotHopper(Case):
    """A flat silo whose floor opens in a slot at t = 0, between two walls; plane in the mean, periodic over `depth`.

    The packing settles on a closed floor with low friction, is cut at `filling` (grains whose centre lies above are
    taken out) and relaxes with the full friction of floor and walls; what falls out leaves.
    """

    kind: Literal["slot-hopper"] = "slot-hopper"
    opening: Positive
    width: Positive = 0.6
    filling: Positive = 0.66
    depth: Positive = 0.06
    gravity: Positive = 9.81
    relaxation: Positive = 0.15
    end: Positive = 0.9
    output_interval: Positive = 0.018


class RoughDrum(Case):
    """A drum, half full, that turns steadily about its level axis; plane in the mean, periodic over `depth`.

    Its wall is a layer of glued grains that turn with it, so that the packing begins at `radius`. The packing settles
    in the resting drum with low friction, is cut at the level of the axis (grains whose centre lies above are taken
    out), relaxes with the full friction, and the drum turns from t = 0 on. Means are taken over an angle after another
    one [rad], in which it turns until grains run down, and by half a turn more: then every grain has run down once.
    """

    kind: Literal["rough-drum"] = "rough-drum"
    radius: Positive
    froude_number: Positive = 0.004
    depth: Positive = 0.06
    gravity: Positive = 9.81
    relaxation: Positive = 0.15
    transient_angle: Positive = 3.8
    averaged_angle: Positive = 1.6
    output_interval: Positive = 0.05

    @property
    def steady_from(self) -> float:
        """When the means begin [s]."""
        return self.transient_angle / self.angular_velocity

    @property
    def end(self) -> float:
        """When they end [s]."""
        return self.steady_from + self.averaged_angle / self.angular_velocity

    @property
    def angular_velocity(self) -> float:
        """Of the drum [rad/s], from the Froude number w^2 R/g; carries grains up at x > 0."""
        return math.sqrt(self.froude_number * self.gravity / self.radius)


AnyCase = (
    Collapse | CylinderCollapse | PlaneShear | WallShear | ShearSteps | Compression | Triaxial | SlotHopper | RoughDrum
)
