"""What the element tests have in common: the settings that start every one of them, and the form of a test."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

from grainlaw.materials.declarations import Parameter, declared_fields
from grainlaw.materials.element.path import LoadingPath

if TYPE_CHECKING:
    from grainlaw.materials.element.mixed import MixedControl

InitialPressure = Annotated[float, Parameter("Pa", "pressure p of the isotropic initial state", "(0, inf)")]
InitialDensity = Annotated[
    float,
    Parameter("kg/m3", "initial bulk density; 0 takes that of the parameter set at the initial pressure", "[0, inf)"),
]
GrainDensity = Annotated[
    float, Parameter("kg/m3", "density rho_p of the grains, for a law that does not declare it", "(0, inf)")
]
GrainDiameter = Annotated[
    float, Parameter("m", "diameter d_p of the grains, for a law that does not declare it", "(0, inf)")
]
TimeStep = Annotated[float, Parameter("s", "time step", "(0, inf)")]
StrainRate = Annotated[float, Parameter("1/s", "strain rate of the driven component", "(0, inf)")]
FinalStrain = Annotated[float, Parameter("1", "strain of the driven component at the end", "(0, inf)")]


class StrainedSettings(NamedTuple):
    """Settings of a test that drives one component to a final strain at constant rate."""

    initial_pressure: InitialPressure = 100e3
    density: InitialDensity = 0.0
    grain_density: GrainDensity = 2450.0
    strain_rate: StrainRate = 0.01
    final_strain: FinalStrain = 0.3
    time_step: TimeStep = 1e-3


@dataclass(frozen=True)
class ElementTest:
    """A homogeneous element test: its name, one line about it, its settings and the path that they describe.

    settings  NamedTuple class whose fields are annotated with `Parameter`, all with defaults
    path      settings -> the path to follow; a mixed control is one too
    """

    name: str
    summary: str
    settings: type[Any]
    path: "Callable[[Any], LoadingPath | MixedControl]"

    @property
    def setting_declarations(self) -> dict[str, Parameter]:
        """Setting declarations by name."""
        return declared_fields(self.settings, Parameter)
