"""Mixed control: in every stage each component follows a strain rate or a stress rate, given in a TOML file.

    time_step = 1e-3                            # s

    [[stage]]
    duration = 10.0                             # s
    strain_rate = { yy = -0.01 }                # 1/s, tension-positive
    stress_rate = { xx = 0.0, zz = 0.0 }        # Pa/s; 0 holds the stress at its value at the start of the stage

A component that a stage does not name has no strain rate. Frame and density are as in `driver`.
"""

from pathlib import Path
from typing import Annotated, Literal, NamedTuple, Self, get_args

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError, model_validator

from grainlaw.materials.element.path import steps_of
from grainlaw.materials.element.settings import ElementTest, GrainDensity, InitialDensity, InitialPressure
from grainlaw.materials.errors import InputError, nearest_name
from grainlaw.materials.faults import fault_in_words
from grainlaw.materials.tensor import SymmetricTensor
from grainlaw.materials.toml_file import read_toml

Component = Literal["xx", "yy", "zz", "xy", "yz", "xz"]
COMPONENTS: tuple[Component, ...] = get_args(Component)
Positive = Annotated[FiniteFloat, Field(gt=0.0)]


class MixedSettings(NamedTuple):
    """Settings of a test under mixed control, beside its control file."""

    initial_pressure: InitialPressure = 100e3
    density: InitialDensity = 0.0
    grain_density: GrainDensity = 2450.0


class Stage(BaseModel):
    """A stage of a mixed test: strain rates [1/s] and stress rates [Pa/s] by component, over a duration [s]."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    duration: Positive
    strain_rate: dict[Component, FiniteFloat] = {}
    stress_rate: dict[Component, FiniteFloat] = {}

    @model_validator(mode="after")
    def _one_control_per_component(self) -> Self:
        for component in self.strain_rate:
            if component in self.stress_rate:
                raise ValueError(f"{component} has both a strain rate and a stress rate; give one of them")
        return self

    @property
    def prescribed(self) -> SymmetricTensor:
        """The strain rate [1/s], with 0 for the components whose stress is prescribed."""
        return SymmetricTensor(*(self.strain_rate.get(name, 0.0) for name in COMPONENTS))

    @property
    def controlled(self) -> list[int]:
        """The indices of the components whose stress is prescribed, in the order of `stress_rate`."""
        return [COMPONENTS.index(name) for name in self.stress_rate]


class MixedControl(BaseModel):
    """The control of a mixed test: time step [s] and stages."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    time_step: Positive
    stage: Annotated[tuple[Stage, ...], Field(min_length=1)]

    @property
    def steps(self) -> int:
        """The number of steps of all stages together."""
        return sum(steps_of(stage.duration, self.time_step) for stage in self.stage)


def read_control(path: Path) -> MixedControl:
    """The control in a TOML file. Raises InputError with the first fault."""
    try:
        return MixedControl.model_validate(read_toml(path, "control file"))
    except ValidationError as error:
        raise InputError(f"control file {path}: {_first_fault(error)}") from error


def _first_fault(error: ValidationError) -> str:
    # A misspelt key explains the missing one better than the other way round.
    faults = error.errors()
    fault = next((found for found in faults if found["type"] == "extra_forbidden"), faults[0])
    key = ".".join(str(part) for part in fault["loc"] if part != "[key]")
    if fault["type"] == "extra_forbidden":
        model = MixedControl if len(fault["loc"]) == 1 else Stage
        return f"unknown key '{key}'; {nearest_name(str(fault['loc'][-1]), model.model_fields)}"
    return fault_in_words(fault, key)


def mixed_test(control: MixedControl) -> ElementTest:
    """The element test that follows a mixed control."""
    return ElementTest("mixed", "stages of strain rates and stress rates from a file", MixedSettings, lambda _: control)
