"""`run.json` beside a file of points: where its axis and its floor are, as beside dumps of grains."""

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from grainlaw.materials import InputError
from grainlaw.materials.faults import fault_in_words
from grainlaw.mpm_core.space import AXISYMMETRIC, PLANE_STRAIN, Space
from grainlaw.validation.grains.observation import SPACES
from grainlaw.validation.grains.readers.text_file import BYTE_ORDER_MARK
from grainlaw.validation.grains.run_description import RUN_DESCRIPTION_NAME


class StateDescription(BaseModel):
    """What a file of points does not tell; SI units. Other keys are kept as provenance.

    code         what the code is called in tables; default: the name of the file
    space        "plane_strain" or "axisymmetric"; default: that of the run
    up           axis against gravity of points in space: "z", the default, or "y"
    center       of the column along x [m]
    axis         of a cylinder in space, along x and the other horizontal axis [m]; default: the centre of mass
    floor_level  level from which heights count [m]
    half         whether the points are the half beyond `center` of a symmetric column
    time         of the state on the code's clock [s], where the file tells none
    release_time on the code's clock [s]
    """

    model_config = ConfigDict(extra="allow", frozen=True, allow_inf_nan=False)

    code: str = ""
    space: Literal["plane_strain", "axisymmetric"] | None = None
    up: Literal["y", "z"] | None = None
    center: float = 0.0
    axis: tuple[float, float] | None = None
    floor_level: float = 0.0
    half: bool = False
    time: float | None = Field(default=None, ge=0)
    release_time: float = 0.0

    def in_space(self, of_run: Space) -> Space:
        """The space in which the points are compared; a run in 3D is a plane column unless told otherwise."""
        if self.space is not None:
            return SPACES[self.space]
        return AXISYMMETRIC if of_run.hoop else PLANE_STRAIN


def read_state_description(file: Path) -> StateDescription:
    """The description beside a file, or the defaults. Raises InputError in one line if it is damaged."""
    path = file.parent / RUN_DESCRIPTION_NAME
    if not path.is_file():
        return StateDescription()
    try:
        return StateDescription.model_validate_json(path.read_bytes().removeprefix(BYTE_ORDER_MARK))
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{path}: {fault_in_words(first, key)}") from None
