"""`run.json`: what a DEM run was, beside its dumps."""

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from grainlaw.materials import InputError
from grainlaw.materials.faults import fault_in_words
from grainlaw.validation.grains.readers.text_file import BYTE_ORDER_MARK

RUN_DESCRIPTION_NAME = "run.json"


class FrameEntry(BaseModel):
    """One dump of the run: its file, its time on the run's clock [s] and the file of the contacts, if any."""

    model_config = ConfigDict(extra="allow", frozen=True, allow_inf_nan=False)

    file: str
    time: float | None = None
    contacts: str | None = None


class RunDescription(BaseModel):
    """A DEM run in SI units; x along the slope, y along the depth, z up; other keys are kept as provenance.

    space          "plane_strain": a column that is plane in the mean; "axisymmetric": a cylinder
    depth          length along y over which the grains are averaged [m]; needed in plane strain, not used otherwise
    axis           of the cylinder in x and y [m]; without it, the centre of mass of the first frame
    frames         the dumps; without it, every file of the folder that looks like one
    grains_files   instead of frames: a pattern of the dumps' names
    release_time   on the run's clock [s]; all other times count from it
    time_step      turns the step number of a LIGGGHTS dump, in VTK that of its name, into a time [s]
    floor_level    level from which heights count [m]
    center         of the column along x [m]
    solid_fraction of the packing before the release; without it, that of the first frame
    mobile_types   types of the grains that count; needed where a dump holds several, as with a floor of glued grains
    """

    model_config = ConfigDict(extra="allow", frozen=True, allow_inf_nan=False)

    space: Literal["plane_strain", "axisymmetric"] = "plane_strain"
    depth: float | None = Field(default=None, gt=0)
    axis: tuple[float, float] | None = None
    grain_density: float = Field(gt=0)
    case: str = ""
    code: str = ""
    seed: int | None = None
    wall_time: float | None = None
    cpu_time: float | None = None
    steps: int | None = None
    frames: tuple[FrameEntry, ...] | None = None
    grains_files: str = ""
    release_time: float = 0.0
    time_step: float | None = Field(default=None, gt=0)
    floor: str = ""
    floor_level: float = 0.0
    center: float = 0.0
    half_width: float | None = Field(default=None, gt=0)
    initial_height: float | None = Field(default=None, gt=0)
    mean_diameter: float | None = Field(default=None, gt=0)
    gravity: float = Field(default=9.81, gt=0)
    solid_fraction: float | None = Field(default=None, gt=0, lt=1)
    mobile_types: tuple[int, ...] | None = None

    @model_validator(mode="after")
    def _plane_columns_have_a_depth(self) -> "RunDescription":
        if self.depth is None and not self.is_round:
            raise ValueError("'depth' is missing; only a cylinder, space = 'axisymmetric', has none")
        return self

    @property
    def is_round(self) -> bool:
        """Whether the grains are averaged around an axis."""
        return self.space == "axisymmetric"


def read_run_description(folder: Path) -> RunDescription:
    """The description in a run's folder. Raises InputError in one line if it is missing or wrong."""
    path = folder / RUN_DESCRIPTION_NAME
    if not path.is_file():
        raise InputError(f"{folder} holds no {RUN_DESCRIPTION_NAME}, which tells at least depth and grain_density")
    try:
        return RunDescription.model_validate_json(path.read_bytes().removeprefix(BYTE_ORDER_MARK))
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{path}: {fault_in_words(first, key)}") from None
