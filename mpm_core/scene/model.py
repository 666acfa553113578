"""The scene: everything that a run needs, as a validated model that reads and writes TOML."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

import tomli_w
from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, ValidationError, field_validator, model_validator

from grainlaw.materials import InputError, get_material
from grainlaw.materials.errors import nearest_name
from grainlaw.materials.law import Law
from grainlaw.mpm_core.scene.errors import described
from grainlaw.mpm_core.scene.file import read_content
from grainlaw.mpm_core.scene.presets import with_settings_for_accuracy
from grainlaw.mpm_core.scene.shapes import AnyShape, Corner

# Beyond these a number is a slip of the unit, or overflows on its way through a run.
LARGEST_SPEED, LARGEST_GRAVITY, LARGEST_DENSITY = 1e6, 1e6, 1e6  # m/s, m/s2, kg/m3
LARGEST_PRESSURE, LARGEST_RATIO = 1e12, 1e3  # Pa, 1
# The widest stencil: over fewer cells it would reach the same node twice.
FEWEST_PERIODIC_CELLS = 4


class Section(BaseModel):
    """A table of a scene file; unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)


def _at_most(vector: Corner, largest: float, unit: str) -> Corner:
    """The vector. Raises ValueError if one of its components is larger, or negative and larger."""
    for component in vector:
        if abs(component) > largest:
            raise ValueError(f"{component:g} {unit} is out of bounds; allowed: {-largest:g} to {largest:g} {unit}")
    return vector


class GridSection(Section):
    """The background grid."""

    cell_size: float = Field(gt=0, description="edge of a square cell [m]; may be left to `accuracy`")
    lower: Corner = Field(default=(0.0, 0.0), description="lower left corner of the domain [m]")
    upper: Corner = Field(description="upper right corner of the domain [m]; a whole number of cells from `lower`")

    @property
    def cells(self) -> tuple[int, int]:
        """Number of cells along x and y."""
        counts = [round((self.upper[axis] - self.lower[axis]) / self.cell_size) for axis in (0, 1)]
        return counts[0], counts[1]

    @model_validator(mode="after")
    def _whole_cells(self) -> "GridSection":
        for axis, name in enumerate("xy"):
            length = self.upper[axis] - self.lower[axis]
            if not math.isfinite(length / self.cell_size):
                raise ValueError(f"the domain is {length:g} m along {name}, too many cells of {self.cell_size:g} m")
            whole = round(length / self.cell_size) * self.cell_size
            if whole <= 0 or abs(whole - length) > 1e-6 * self.cell_size:
                raise ValueError(
                    f"the domain is {length:g} m along {name}, not a whole number of cells of {self.cell_size:g} m; "
                    f"nearest: {max(whole, self.cell_size):g} m"
                )
        return self


class WallSection(Section):
    """A wall, or a side joined to its opposite."""

    kind: Literal["free_slip", "no_slip", "friction", "periodic"] = Field(
        description="free_slip and no_slip hold the material at the wall; friction lets it leave and slide"
    )
    coefficient: float = Field(default=0.0, ge=0, description="Coulomb friction coefficient of a friction wall [1]")
    velocity: float = Field(
        default=0.0,
        ge=-LARGEST_SPEED,
        le=LARGEST_SPEED,
        description="speed at which a friction or no_slip wall slides along itself, towards +x or +y [m/s]",
    )

    @model_validator(mode="after")
    def _coefficient_belongs_to_friction(self) -> "WallSection":
        if self.kind == "friction" and "coefficient" not in self.model_fields_set:
            raise ValueError("kind = 'friction' needs a coefficient")
        if self.kind != "friction" and self.coefficient > 0:
            raise ValueError("a coefficient belongs to kind = 'friction', and to no other")
        return self

    @model_validator(mode="after")
    def _velocity_belongs_to_a_wall_that_grips(self) -> "WallSection":
        if self.velocity and self.kind not in ("friction", "no_slip"):
            raise ValueError("a velocity belongs to kind = 'friction' or 'no_slip', which can pass it on")
        return self


class BoundarySection(Section):
    """What happens at the four sides of the domain."""

    left: WallSection = Field(default=WallSection(kind="free_slip"), description="side x = lower")
    right: WallSection = Field(default=WallSection(kind="free_slip"), description="side x = upper")
    bottom: WallSection = Field(default=WallSection(kind="free_slip"), description="side y = lower")
    top: WallSection = Field(default=WallSection(kind="free_slip"), description="side y = upper")

    @field_validator("*", mode="before")
    @classmethod
    def _short_form(cls, value: Any) -> Any:
        return {"kind": value} if isinstance(value, str) else value

    @model_validator(mode="after")
    def _periodic_in_pairs(self) -> "BoundarySection":
        for first, second in (("left", "right"), ("bottom", "top")):
            kinds = {getattr(self, first).kind, getattr(self, second).kind}
            if "periodic" in kinds and len(kinds) > 1:
                raise ValueError(f"periodic sides come in pairs: set both {first} and {second}")
        return self


class TimeSection(Section):
    """Duration and time step."""

    end: float = Field(gt=0, description="simulated time [s]")
    safety: float = Field(
        default=0.4, gt=0, le=1, description="fraction of the stable step that is taken; 1 is the limit [1]"
    )
    step: float | None = Field(
        default=None, gt=0, description="fixed step [s]; refused where it is above the stable one; default: adaptive"
    )
    smallest_step: float | None = Field(
        default=None,
        gt=0,
        description="the run stops if it would have to step below this [s]; default: 1e-4 of the first step",
    )


# The decay time of velocities below the grid's resolution over the cell size [s/m]. With one time for all cells piles
# do not converge: flow at nearly constant friction is unstable against short waves, which a long time keeps alive.
BLEND_TIME_PER_CELL = 0.1


class TransferSection(Section):
    """Shape functions and the transfer between points and grid."""

    basis: Literal["linear", "quadratic", "cubic"] = Field(default="quadratic", description="B-spline shape functions")
    scheme: Literal["affine_flip", "apic"] = Field(
        default="affine_flip",
        description="affine_flip keeps velocities below the grid's resolution for `time_constant`; apic drops them",
    )
    time_constant: float | None = Field(
        default=None,
        gt=0,
        description="decay time of velocities below the grid's resolution (affine_flip only); default: 0.1 s/m times "
        "the cell size [s]",
    )
    volume_projection: bool = Field(
        default=True,
        description="points of loose grains are moved apart until they leave each cell the room it has",
    )


class SleepSection(Section):
    """Rest: where nothing moves, nothing is computed (`grainlaw.mpm_core.stepping.sleeping`)."""

    speed: float | None = Field(
        default=None,
        gt=0,
        description="points that moved slower than this over `window`, with all around them, sleep until something "
        "moves them; a creeping point stays behind by this times the time asleep [m/s]; default: nothing sleeps",
    )
    window: float = Field(default=0.05, gt=0, description="how long a point has to rest before it sleeps [s]")
    start: float = Field(
        default=0.0, ge=0, description="when the first window begins; for flows that begin at rest [s]"
    )


class InitialStressSection(Section):
    """The stress of a body at the start."""

    kind: Literal["none", "uniform", "geostatic", "table"] = Field(
        default="none",
        description="no stress, a uniform pressure, the weight of the material above, of all bodies, or a table over "
        "depth",
    )
    pressure: float = Field(default=0.0, ge=0, le=LARGEST_PRESSURE, description="pressure of kind = 'uniform' [Pa]")
    horizontal_ratio: float = Field(
        default=1.0, ge=0, le=LARGEST_RATIO, description="sigma_xx/sigma_yy, unless the stress is uniform [1]"
    )
    out_of_plane_ratio: float = Field(
        default=0.5,
        ge=0,
        le=LARGEST_RATIO,
        description="sigma_zz/(sigma_xx + sigma_yy), unless the stress is uniform; 0.5 with ratio 1: isotropic [1]",
    )
    surcharge: float = Field(
        default=0.0,
        ge=0,
        le=LARGEST_PRESSURE,
        description="load on the body where nothing covers it, for kind = 'geostatic'; what lies below carries it, "
        "too [Pa]",
    )

    depth: list[float] | None = Field(
        default=None, min_length=2, description="increasing depths of kind = 'table', below the free top [m]"
    )
    vertical_stress: list[float] | None = Field(
        default=None,
        min_length=2,
        description="vertical stress at each `depth`, compression positive; linear between them [Pa]",
    )

    @model_validator(mode="after")
    def _table_is_complete(self) -> "InitialStressSection":
        if self.kind != "table":
            if self.depth is not None or self.vertical_stress is not None:
                raise ValueError("depth and vertical_stress belong to kind = 'table', and to no other")
            return self
        if self.depth is None or self.vertical_stress is None or len(self.depth) != len(self.vertical_stress):
            raise ValueError("kind = 'table' needs depth and vertical_stress, lists of one length")
        if any(second <= first for first, second in pairwise(self.depth)):
            raise ValueError("depth must increase from value to value")
        for stress in self.vertical_stress:
            if not 0 <= stress <= LARGEST_PRESSURE:
                allowed = f"0 to {LARGEST_PRESSURE:g} Pa (compression is positive)"
                raise ValueError(f"vertical_stress holds {stress:g} Pa; allowed: {allowed}")
        return self

    @model_validator(mode="after")
    def _surcharge_belongs_to_geostatic(self) -> "InitialStressSection":
        if self.surcharge > 0 and self.kind != "geostatic":
            raise ValueError("a surcharge belongs to kind = 'geostatic', and to no other")
        return self


class BodySection(Section):
    """A body: shape, material, initial state."""

    material: str = Field(description="name of a [material.NAME] table")
    shape: AnyShape = Field(description="rectangle, disc, polygon or mesh")
    density: float = Field(gt=0, le=LARGEST_DENSITY, description="initial bulk density [kg/m3]")
    points_per_cell: Literal[1, 4, 9, 16, 25, 36] = Field(
        default=4, description="material points per cell, a square number; may be left to `accuracy`"
    )
    velocity: Corner = Field(default=(0.0, 0.0), description="initial velocity [m/s]")
    initial_stress: InitialStressSection = Field(
        default=InitialStressSection(),
        description="stress at the start; a law whose stiffness grows with pressure, as Cam Clay, needs one",
    )

    @field_validator("velocity")
    @classmethod
    def _velocity_has_a_bound(cls, velocity: Corner) -> Corner:
        return _at_most(velocity, LARGEST_SPEED, "m/s")


# More frames, or rows of the history, are a slip of the unit rather than a wish.
MOST_FRAMES, MOST_HISTORY_ROWS = 100_000, 10_000_000


class OutputSection(Section):
    """What a run writes."""

    interval: float | None = Field(default=None, gt=0, description="time between frames [s]; default: end/30")
    history_interval: float | None = Field(
        default=None, gt=0, description="time between history rows [s]; default: end/300"
    )
    fields: list[str] | None = Field(
        default=None,
        description="fields of each frame; default: velocity, pressure, deviatoric_stress, shear_strain, "
        "solid_fraction where the law knows the grain density, and the state variables that the law marks for output; "
        "frames of several materials hold body, too",
    )
    picture_field: str | None = Field(
        default=None,
        description="field that final.png and snapshots.png are coloured by, a vector by its length; frames then hold "
        "it; default: shear_strain, or the first one of `fields`",
    )
    vtu: bool = Field(default=True, description="write points_NNNNNN.vtu and run.pvd")
    vtkhdf: bool = Field(default=False, description="write all frames to one run.vtkhdf")
    pictures: bool = Field(default=True, description="draw PNG pictures at the end (needs vtu)")


class Scene(Section):
    """A complete scene."""

    title: str = Field(default="", description="one line for reports")
    accuracy: Literal["10%", "3%", "1%"] | None = Field(
        default=None,
        description="sets grid.cell_size, time.safety, body.points_per_cell and precision "
        "where the scene does not, to what kept runout, height and centre of mass of column collapses within this of "
        "finer grids; refused where that was not reached, and for bodies few grains wide, or more slender than those "
        "with which it was",
    )
    precision: Literal["double", "single"] = Field(
        default="double",
        description="of nodes and points, but for places and densities, and of the arithmetic of laws that hold in it",
    )
    gravity: Corner = Field(default=(0.0, -9.81), description="gravity vector [m/s2]")
    grid: GridSection
    time: TimeSection
    boundary: BoundarySection = Field(default=BoundarySection())
    transfer: TransferSection = Field(default=TransferSection())
    sleep: SleepSection = Field(default=SleepSection())
    material: dict[str, dict[str, Any]] = Field(
        min_length=1, description="[material.NAME]: the law's parameters, and `law` if NAME is not the law's own name"
    )
    body: Annotated[list[BodySection], Field(min_length=1)]
    output: OutputSection = Field(default=OutputSection())
    _source: str = PrivateAttr(default="scene")

    @field_validator("gravity")
    @classmethod
    def _gravity_has_a_bound(cls, gravity: Corner) -> Corner:
        return _at_most(gravity, LARGEST_GRAVITY, "m/s2")

    @property
    def source(self) -> str:
        """The file that the scene was read from, for messages."""
        return self._source

    @property
    def blend_time(self) -> float:
        """The decay time of velocities below the grid's resolution [s]; zero for APIC, which drops them."""
        if self.transfer.scheme == "apic":
            return 0.0
        return self.transfer.time_constant or BLEND_TIME_PER_CELL * self.grid.cell_size

    @model_validator(mode="before")
    @classmethod
    def _settings_for_accuracy(cls, content: Any) -> Any:
        return with_settings_for_accuracy(content)

    @model_validator(mode="after")
    def _periodic_axes_are_wide_enough(self) -> "Scene":
        for cells, side in zip(self.grid.cells, ("left", "bottom"), strict=True):
            if getattr(self.boundary, side).kind == "periodic" and cells < FEWEST_PERIODIC_CELLS:
                raise ValueError(
                    f"boundary.{side} is periodic over {cells} cells of the grid; "
                    f"allowed: {FEWEST_PERIODIC_CELLS} or more"
                )
        return self

    @model_validator(mode="after")
    def _files_stay_countable(self) -> "Scene":
        for name, most in (("interval", MOST_FRAMES), ("history_interval", MOST_HISTORY_ROWS)):
            interval = getattr(self.output, name)
            if interval is not None and self.time.end > most * interval:
                raise ValueError(
                    f"output.{name} = {interval:g} s is {self.time.end / interval:.3g} times until time.end = "
                    f"{self.time.end:g} s; allowed: {most} times or fewer"
                )
        return self

    @model_validator(mode="after")
    def _materials_exist(self) -> "Scene":
        for number, body in enumerate(self.body):
            if body.material not in self.material:
                raise ValueError(
                    f"body.{number}.material = '{body.material}': {nearest_name(body.material, self.material)}"
                )
        return self

    def law(self, material: str) -> Law:
        """The law of a [material.NAME] table. Raises InputError for an unknown one."""
        try:
            return get_material(str(self.material[material].get("law", material)))
        except InputError as error:
            raise InputError(f"material.{material}: {error}") from error

    def parameters(self, material: str) -> Any:
        """The parameters of a [material.NAME] table as the law's NamedTuple. Raises InputError for bad values."""
        values = {name: value for name, value in self.material[material].items() if name != "law"}
        return self.law(material).checked(values, f"material.{material}")

    @classmethod
    def from_dict(cls, content: dict[str, Any], source: str = "scene") -> "Scene":
        """Validate a scene given as nested dictionaries. Raises InputError in one line."""
        try:
            scene = cls.model_validate(content)
        except ValidationError as error:
            raise InputError(f"{source}: {described(error, cls, content)}") from None
        scene._source = source
        for material in scene.material:
            try:
                scene.parameters(material)
            except InputError as error:
                raise InputError(f"{source}: {error}") from None
        return scene

    @classmethod
    def load(cls, path: Path, overrides: dict[str, Any] | None = None, source: str = "") -> "Scene":
        """Read a TOML scene, with values by dotted key set on top. Raises InputError in one line.

        Messages call it `source`, by default its path.
        """
        return cls.from_dict(read_content(path, overrides or {}), source or str(path))

    def to_toml(self) -> str:
        """The scene with every default written out."""
        return tomli_w.dumps(self.model_dump(mode="json", exclude_none=True))
