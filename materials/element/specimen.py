"""The specimen of an element test: a law with its parameter values, where they came from, and its density at rest."""

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from grainlaw.materials.calibration.parameter_values import read_values
from grainlaw.materials.declarations import checked_parameters
from grainlaw.materials.element.settings import ElementTest
from grainlaw.materials.errors import InputError, InputWarning, nearest_name
from grainlaw.materials.law import Law
from grainlaw.materials.registry import get_material


@dataclass(frozen=True)
class Specimen:
    """A law, its parameter values (the law's NamedTuple), a short label, and a line on where the values came from."""

    law: Law
    parameters: Any
    label: str
    source: str

    def density(self, pressure: float, stated: float) -> float:
        """The stated initial bulk density [kg/m3] or, if that is 0, the one of the law's first set at the pressure.

        Raises InputError if there is none.
        """
        if stated > 0.0:
            return stated
        if not self.law.parameter_sets:
            raise InputError(f"{self.law.name} has no named parameter set to take a density from; set density [kg/m3]")
        chosen = next(iter(self.law.parameter_sets.values()))
        try:
            density = chosen.density(pressure, self.parameters)
        except (ArithmeticError, ValueError):
            density = math.nan
        if not 0.0 < density < math.inf:
            raise InputError(f"{self.law.name} has no density at rest under {pressure:g} Pa; set density [kg/m3]")
        return density

    def warn_about_density(self, pressure: float, stated: float) -> None:
        """Warn, as InputWarning, about an initial density, as of `density`, above that of the law's grains."""
        density, grain_density = self.density(pressure, stated), self.declared("grain_density", math.inf)
        if density <= grain_density:
            return
        above = f"{density:.6g} kg/m3 is above the density of the grains, {grain_density:g} kg/m3"
        if stated > 0.0:
            message = f"{self.law.name}: density = {above}; no packing is as dense"
        else:
            message = (
                f"{self.law.name}: the initial density {above}: the parameter set's density at {pressure:g} Pa is "
                "nominal, and so are densities and specific volumes of this test; set density [kg/m3] for others"
            )
        warnings.warn(message, InputWarning, stacklevel=2)

    def declared(self, name: str, otherwise: float) -> float:
        """A parameter if the law declares it, else the other value."""
        return float(getattr(self.parameters, name, otherwise))


def prepared(
    law_name: str, parameters: str | Path | None, assignments: Mapping[str, float], test: ElementTest
) -> tuple[Specimen, Any]:
    """The specimen and the settings of a test.

    parameters   name of one of the law's parameter sets, or the path of a TOML file; None takes the law's first set
    assignments  values by name, each a parameter of the law or, where it has none of that name, a setting of the test

    Raises InputError for an unknown law, set, file or name and for a value out of bounds.
    """
    law = get_material(law_name)
    values, label, source = base_values(law, parameters)
    own = _own_settings(law, parameters, test)
    of_law, of_test = _sorted_out(law, test, assignments)
    if of_law:
        changes = " with " + ", ".join(f"{name} = {value:g}" for name, value in of_law.items())
        label, source = label + changes, source + changes
    specimen = Specimen(law, law.checked({**values, **of_law}, law.name), label, source)
    shared = {name: value for name, value in specimen.parameters._asdict().items() if name in test.settings._fields}
    return specimen, checked_parameters(test.name, test.settings, {**own, **of_test, **shared})


def base_values(law: Law, parameters: str | Path | None) -> tuple[dict[str, Any], str, str]:
    """Values by name before any assignment, a label for figures, and where the values came from.

    `parameters` is as for `prepared`. Raises InputError for an unknown set or a file that cannot be read.
    """
    if parameters is None:
        if not law.parameter_sets:
            return {}, law.name, "values given one by one"
        parameters = next(iter(law.parameter_sets))
    name = str(parameters)
    label = f"{law.name} {Path(name).stem}"
    if name.endswith(".toml"):
        return read_values(Path(name)), label, f"file {name}"
    if name not in law.parameter_sets:
        raise InputError(f"{law.name} has no parameter set '{name}'; {nearest_name(name, law.parameter_sets)}")
    found = law.parameter_sets[name]
    return found.parameters._asdict(), label, f"set '{name}' ({found.source})"


def _own_settings(law: Law, parameters: str | Path | None, test: ElementTest) -> Mapping[str, float]:
    """The settings that the parameter set, of values from a file the law's first one, has for a test."""
    sets = law.parameter_sets
    chosen = sets.get(str(parameters)) or next(iter(sets.values()), None)
    return chosen.element_settings.get(test.name, {}) if chosen else {}


def _sorted_out(
    law: Law, test: ElementTest, assignments: Mapping[str, float]
) -> tuple[dict[str, float], dict[str, float]]:
    """The assignments that belong to the law and those that belong to the test."""
    of_law, of_test = law.parameter_declarations, test.setting_declarations
    for name in assignments:
        if name not in of_law and name not in of_test:
            hint = nearest_name(name, {**of_law, **of_test})
            raise InputError(f"neither {law.name} nor the element test {test.name} has '{name}'; {hint}")
    return (
        {name: value for name, value in assignments.items() if name in of_law},
        {name: value for name, value in assignments.items() if name not in of_law},
    )
