"""The scene: everything that a run needs, as a validated model that reads and writes TOML."""

import math
from pathlib import Path
from typing import Any, Literal

import tomli_w
from pydantic import Field, PrivateAttr, ValidationError, field_validator, model_validator

from grainlaw.materials import InputError, get_material
from grainlaw.materials.errors import nearest_name
from grainlaw.materials.law import Law
from grainlaw.mpm_core.scene.body_section import BodySection, InitialStressSection
from grainlaw.mpm_core.scene.boundary import BoundarySection
from grainlaw.mpm_core.scene.errors import described
from grainlaw.mpm_core.scene.file import read_content
from grainlaw.mpm_core.scene.inflow import InflowSection
from grainlaw.mpm_core.scene.obstacle import ObstacleSection
from grainlaw.mpm_core.scene.outline import Points
from grainlaw.mpm_core.scene.presets import with_settings_for_accuracy
from grainlaw.mpm_core.scene.section import (
    LARGEST_GRAVITY,
    Section,
    Vector,
    refuse_beyond,
)
from grainlaw.mpm_core.scene.shapes import lattice, refused_mesh
from grainlaw.mpm_core.scene.space_rules import fitted_to_space
from grainlaw.mpm_core.space import SPACES, Space

# A stencil then reaches nodes twice, as their own images; over a single one it would be nothing but images.
FEWEST_PERIODIC_CELLS = 2


class GridSection(Section):
    """The background grid."""

    cell_size: float = Field(gt=0, description="edge of a cell, a square or a cube [m]; may be left to `accuracy`")
    lower: Vector = Field(
        default=(0.0, 0.0), description="lower corner of the domain, in 3D of three components [m]; default: the origin"
    )
    upper: Vector = Field(description="upper corner of the domain [m]; a whole number of cells from `lower`")

    @property
    def cells(self) -> tuple[int, ...]:
        """Number of cells along each axis."""
        return tuple(round((high - low) / self.cell_size) for low, high in zip(self.lower, self.upper, strict=True))

    @model_validator(mode="after")
    def _whole_cells(self) -> "GridSection":
        for name, low, high in zip("xyz", self.lower, self.upper, strict=False):
            length = high - low
            if not math.isfinite(length / self.cell_size):
                raise ValueError(f"the domain is {length:g} m along {name}, too many cells of {self.cell_size:g} m")
            whole = round(length / self.cell_size) * self.cell_size
            if whole <= 0 or abs(whole - length) > 1e-6 * self.cell_size:
                raise ValueError(
                    f"the domain is {length:g} m along {name}, not a whole number of cells of {self.cell_size:g} m; "
                    f"nearest: {max(whole, self.cell_size):g} m"
                )
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
    movie: bool = Field(
        default=False, description="make a film of the frames at the end, movie.mp4, by ffmpeg (needs vtu)"
    )

    @model_validator(mode="after")
    def _film_has_frames(self) -> "OutputSection":
        if self.movie and not self.vtu:
            raise ValueError("movie = true needs the frames that vtu = false leaves out")
        return self


class Scene(Section):
    """A complete scene."""

    title: str = Field(default="", description="one line for reports")
    space: Literal["plane_strain", "axisymmetric", "3d"] = Field(
        default="plane_strain",
        description="plane_strain: x right, y up, one metre of width; axisymmetric: x is the radius, y up, a radian "
        "around the axis x = 0; 3d: x right, y back, z up",
    )
    accuracy: Literal["10%", "3%", "1%"] | None = Field(
        default=None,
        description="sets grid.cell_size, time.safety, body.points_per_cell and precision "
        "where the scene does not, to what kept runout, height and centre of mass of column collapses within this of "
        "finer grids; refused where no measurement confirms it, and for bodies few grains wide, or more slender than "
        "those that were measured",
    )
    precision: Literal["double", "single"] = Field(
        default="double",
        description="of nodes and points, but for places and densities, and of the arithmetic of laws that hold in it",
    )
    gravity: Vector = Field(
        default=(0.0, -9.81), description="gravity vector [m/s2]; in 3D, where z is up, default: [0, 0, -9.81]"
    )
    grid: GridSection
    time: TimeSection
    boundary: BoundarySection = Field(default=BoundarySection())
    transfer: TransferSection = Field(default=TransferSection())
    sleep: SleepSection = Field(default=SleepSection())
    material: dict[str, dict[str, Any]] = Field(
        min_length=1, description="[material.NAME]: the law's parameters, and `law` if NAME is not the law's own name"
    )
    body: list[BodySection] = Field(default=[])
    inflow: list[InflowSection] = Field(default=[])
    obstacle: list[ObstacleSection] = Field(default=[])
    output: OutputSection = Field(default=OutputSection())
    _source: str = PrivateAttr(default="scene")

    @field_validator("gravity")
    @classmethod
    def _gravity_has_a_bound(cls, gravity: Vector) -> Vector:
        refuse_beyond(gravity, LARGEST_GRAVITY, "m/s2")
        return gravity

    @property
    def source(self) -> str:
        """The file that the scene was read from, for messages."""
        return self._source

    @property
    def in_space(self) -> Space:
        """The space of the scene."""
        return SPACES[self.space]

    @property
    def with_points(self) -> list[BodySection | InflowSection]:
        """What material points come from: the bodies and, behind them, the inflows."""
        return [*self.body, *self.inflow]

    @property
    def materials(self) -> list[str]:
        """The names of the materials of all bodies, and behind them those of the inflows."""
        return [section.material for section in self.with_points]

    @property
    def left_is_axis(self) -> bool:
        """Whether the left side is the axis of an axisymmetric scene, which acts as a free-slip wall."""
        return self.in_space.hoop and self.grid.lower[0] == 0.0

    def lattice(self, body: BodySection) -> Points:
        """The places of a body's points at the start, shape (n, axes) [m]."""
        grid, shape = self.grid, body.shape
        domain = (grid.lower, grid.upper) if body.clip else None
        return lattice(shape, grid.lower, grid.cell_size, body.points_per_cell, body.lattice_shift, domain)

    def wall_velocity(self, side: str) -> tuple[float, ...]:
        """The velocity of a side along each axis [m/s]."""
        velocity = self.boundary.of(side).velocity
        if isinstance(velocity, tuple):
            return velocity
        across = next(axis for axis, pair in enumerate(self.in_space.sides) if side in pair)
        return tuple(0.0 if axis == across else velocity for axis in range(self.in_space.axes))

    @property
    def blend_time(self) -> float:
        """The decay time of velocities below the grid's resolution [s]; zero for APIC, which drops them."""
        if self.transfer.scheme == "apic":
            return 0.0
        return self.transfer.time_constant or BLEND_TIME_PER_CELL * self.grid.cell_size

    @model_validator(mode="before")
    @classmethod
    def _defaults_of_space_and_accuracy(cls, content: Any) -> Any:
        return with_settings_for_accuracy(fitted_to_space(content))

    @model_validator(mode="after")
    def _fits_its_space(self) -> "Scene":
        if self.in_space.hoop:
            self._refuse_without_axis()
        self.boundary.refuse_for(self.in_space, self.left_is_axis)
        if not self.body and not self.inflow:
            raise ValueError("body = []: allowed: 1 or more entries, or an [[inflow]]")
        self._refuse_same_names()
        for number, obstacle in enumerate(self.obstacle):
            obstacle.refuse_for(f"obstacle.{number}", self.in_space)
        for number, inflow in enumerate(self.inflow):
            inflow.refuse_for(f"inflow.{number}", self.in_space)
        for number, body in enumerate(self.body):
            if len(body.shape.bounds()[0]) != self.in_space.axes:
                raise ValueError(f"body.{number}.shape: {refused_mesh(body.shape)} in space = '{self.space}'")
            if len(body.lattice_shift) not in {0, self.in_space.axes}:
                raise ValueError(
                    f"body.{number}.lattice_shift = {body.lattice_shift}: allowed: {self.in_space.axes} numbers, one "
                    "for each axis"
                )
            self._refuse_ratio_out_of_plane(f"body.{number}.initial_stress.out_of_plane_ratio", body.initial_stress)
        return self

    def _refuse_ratio_out_of_plane(self, key: str, stress: InitialStressSection) -> None:
        if self.space == "plane_strain" and stress.out_of_plane_ratio is None:
            raise ValueError(f"{key} = None: allowed: a number in space = 'plane_strain'")
        if self.space != "plane_strain" and stress.out_of_plane_ratio is not None:
            raise ValueError(
                f"{key} belongs to space = 'plane_strain'; in space = '{self.space}' horizontal_ratio sets both "
                "horizontal stresses"
            )

    def _refuse_same_names(self) -> None:
        for kind in ("obstacle", "inflow"):
            names = [section.name for section in getattr(self, kind)]
            for number, name in enumerate(names):
                if name in names[:number]:
                    raise ValueError(f"{kind}.{number}.name = '{name}': there is another of that name")

    def _refuse_without_axis(self) -> None:
        if self.grid.lower[0] < 0.0:
            raise ValueError(
                f"grid.lower = {list(self.grid.lower)}: x is the radius in space = 'axisymmetric'; allowed: x >= 0"
            )
        if self.gravity[0] != 0.0:
            raise ValueError(
                f"gravity = {list(self.gravity)}: in space = 'axisymmetric' gravity acts along the axis; allowed: x = 0"
            )

    @model_validator(mode="after")
    def _periodic_axes_are_wide_enough(self) -> "Scene":
        for cells, (side, _) in zip(self.grid.cells, self.in_space.sides, strict=True):
            if self.boundary.kind_of(side) == "periodic" and cells < FEWEST_PERIODIC_CELLS:
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
        for kind in ("body", "inflow"):
            for number, section in enumerate(getattr(self, kind)):
                if section.material not in self.material:
                    hint = nearest_name(section.material, self.material)
                    raise ValueError(f"{kind}.{number}.material = '{section.material}': {hint}")
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
