"""`run.json`: what a DEM run was, beside its dumps."""

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from materials import InputError

RUN_DESCRIPTION_NAME = "run.json"
Vector = tuple[float, float, float]


class Box(BaseModel):
    """The box of the run [m]; its length along y is the depth over which everything is averaged."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    lower: Vector
    upper: Vector


class Column(BaseModel):
    """The column before its release [m]."""

    model_config = ConfigDict(extra="allow", frozen=True, allow_inf_nan=False)

    width: float = Field(gt=0)
    height: float = Field(gt=0)
    center: float = 0.0


class RunDescription(BaseModel):
    """A DEM run in SI units; keys that are not listed here are kept as provenance.

    release_time   on the clock of the dumps [s]; all other times count from it
    times          of the dumps since the release [s], in their order; needed where the dumps tell no time
    time_step      turns the step number of a LIGGGHTS dump into a time [s]
    floor          level from which heights count [m]
    mobile_types   types of the grains that count; needed where a dump holds several, as with a floor of glued grains
    grains_files   pattern of the dumps' names
    """

    model_config = ConfigDict(extra="allow", frozen=True, allow_inf_nan=False)

    case: str = ""
    code: str = ""
    version: str = ""
    seed: int | None = None
    wall_time: float | None = None
    cpu_time: float | None = None
    steps: int | None = None
    grains: int | None = None
    release_time: float = 0.0
    times: tuple[float, ...] | None = None
    time_step: float | None = Field(default=None, gt=0)
    box: Box
    depth_axis: Literal["y"] = "y"
    floor: float = 0.0
    floor_kind: str = ""
    column: Column | None = None
    grain_diameter: float | None = Field(default=None, gt=0)
    grain_density: float = Field(gt=0)
    gravity: float = Field(default=9.81, gt=0)
    solid_fraction: float | None = Field(default=None, gt=0, lt=1)
    mobile_types: tuple[int, ...] | None = None
    grains_files: str = ""
    contacts_files: str = ""

    @property
    def depth(self) -> float:
        """Length of the box along y [m]."""
        return self.box.upper[1] - self.box.lower[1]

    @property
    def center(self) -> float:
        """Where the middle of the column stood along x [m]."""
        return self.column.center if self.column else 0.0


def read_run_description(folder: Path) -> RunDescription:
    """The description in a run's folder. Raises InputError in one line if it is missing or wrong."""
    path = folder / RUN_DESCRIPTION_NAME
    if not path.is_file():
        raise InputError(f"{folder} holds no {RUN_DESCRIPTION_NAME}: it says at least box and grain_density")
    try:
        description = RunDescription.model_validate_json(path.read_bytes())
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"]) or "the file"
        raise InputError(f"{path}: {where}: {first['msg']}") from None
    if description.depth <= 0.0:
        raise InputError(f"{path}: box: the depth along y is {description.depth:g} m; it must be above 0")
    return description
