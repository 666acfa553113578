"""What a constitutive law is: declarations and three pure functions of scalars, and two more that it may have."""

import inspect
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from grainlaw.materials.declarations import (
    DeclarationError,
    Parameter,
    StateVariable,
    checked_parameters,
    declared_fields,
)
from grainlaw.materials.errors import InputError
from grainlaw.materials.resolution import Resolution
from grainlaw.materials.tensor import SymmetricTensor, isotropic

# The version of the interface between laws and grainlaw, and the oldest for which a law may have been written. The
# version rises when a law can use something new, the oldest when a law written for an older one would go wrong.
HOOK_VERSION = 2
OLDEST_HOOK_VERSION = 1
# The version in which laws could first state more than update and sound speed: energy, viscosity, bounds, small steps.
STATEMENTS_VERSION = 2


@dataclass(frozen=True)
class ParameterSet:
    """Named values for a law, with their source and the bulk density [kg/m3] at rest under a given pressure [Pa].

    element_settings  by the names of element tests, the settings whose defaults would lead this material out of the
                      range for which it is meant, with values that do not
    """

    parameters: Any
    source: str
    density: Callable[[float, Any], float] = field(repr=False)
    element_settings: Mapping[str, Mapping[str, float]] = field(default_factory=dict)


def _no_inconsistency(parameters: Any) -> str:
    return ""


def _no_resolutions(parameters: Any) -> Mapping[str, Resolution]:
    return {}


@dataclass(frozen=True, eq=False)
class Law:
    """A constitutive law, declared once and used by the element tests, the MPM core, the output and the docs.

    name            lower-case identifier by which scenes and the command line call the law
    summary         one line for listings
    parameters      NamedTuple class whose fields are annotated with `Parameter`
    state           NamedTuple class whose fields are annotated with `StateVariable` (it may have none)
    initial_state   (stress, density, parameters) -> state; the state in equilibrium with a given stress [Pa] and
                    bulk density [kg/m3]
    update          (stress, strain_rate, density, state, parameters, dt) -> (stress, state); one step of dt [s] at the
                    strain rate D [1/s], ending at `density`; the caller has already rotated the stress
    sound_speed     (stress, density, state, parameters) -> fastest wave speed [m/s]
    parameter_sets  named parameter sets, the first of which element tests take by default
    inconsistency   (parameters) -> what is wrong between parameters that are each within bounds; empty if nothing is
    carries_tension whether the material may be pulled; a law of loose grains leaves it at False
    hook_version    version of this interface that the law was written for, the present one unless it says otherwise; a
                    law in a package of its own states it, so that a grainlaw that is too old or too new can say so
    viscosity       (stress, strain_rate, density, state, parameters) -> viscosity [Pa s] against plane waves, declared
                    by a law whose stress follows the rate of strain itself. Its `sound_speed` is that of waves at a
                    constant rate; its viscosity bounds an explicit step besides, to about rho h^2/(2 viscosity) on
                    cells of h. Since hook version 2
    viscosity_bounds_step  whether the core keeps to that bound; False where friction bounds the viscous stress, which
                    at larger steps changes sign from step to step but does not grow (version 2)
    stored_energy   (stress, density, state, parameters) -> elastic energy per mass [J/kg], zero without stress; with it
                    the ledger of a run tells elastic from dissipated work; None if the law does not know it (version 2)
    lower_bounds    by the names of state variables that the law does not let fall lower, such as the size of a yield
                    surface: (parameters) -> the smallest value; a run counts the points there and says so (version 2)
    small_step      like `update`, but -> (stress, state, succeeded): a shorter way without loops, for steps as small as
                    the core takes, that the compiler can take for many points at once; where it says that it has not
                    succeeded, `update` is called. None for a law whose `update` is that short itself (version 2)
    holds_in_single whether `update` and `sound_speed` hold in single precision: without a loop that ends at a tolerance
                    below 1e-6, nor a difference of numbers that agree to seven digits. Bodies in single precision have
                    other laws computed in double (version 2)
    least_initial_pressure  (parameters) -> pressure [Pa] below which a point has next to no stiffness at the start,
                    because the law's stiffness grows with pressure; a body of a scene that starts there is warned about
                    (version 2)
    resolutions     (parameters) -> how finely a scene has to be resolved for `accuracy = "10%"`, "3%" or "1%"; a scene
                    that asks for an accuracy without an entry is refused

    The functions take and return scalars and NamedTuples, call only `math` and functions marked with
    `pointwise`, and have no side effects.
    """

    name: str
    summary: str
    parameters: type[Any]
    state: type[Any]
    initial_state: Callable[[SymmetricTensor, float, Any], Any]
    update: Callable[[SymmetricTensor, SymmetricTensor, float, Any, Any, float], tuple[SymmetricTensor, Any]]
    sound_speed: Callable[[SymmetricTensor, float, Any, Any], float]
    parameter_sets: Mapping[str, ParameterSet] = field(default_factory=dict)
    inconsistency: Callable[[Any], str] = _no_inconsistency
    carries_tension: bool = False
    hook_version: int = HOOK_VERSION
    viscosity: Callable[[SymmetricTensor, SymmetricTensor, float, Any, Any], float] | None = None
    viscosity_bounds_step: bool = True
    stored_energy: Callable[[SymmetricTensor, float, Any, Any], float] | None = None
    lower_bounds: Mapping[str, Callable[[Any], float]] = field(default_factory=dict)
    small_step: (
        Callable[[SymmetricTensor, SymmetricTensor, float, Any, Any, float], tuple[SymmetricTensor, Any, bool]] | None
    ) = None
    holds_in_single: bool = False
    resolutions: Callable[[Any], Mapping[str, Resolution]] = _no_resolutions
    least_initial_pressure: Callable[[Any], float] | None = None

    def checked(self, values: dict[str, Any], where: str) -> Any:
        """Parameters of this law from values by name; `where` names their place in messages. Raises InputError."""
        parameters = checked_parameters(where, self.parameters, values)
        reason = self.inconsistency(parameters)
        if reason:
            raise InputError(f"{where}: {reason}")
        return parameters

    @property
    def parameter_declarations(self) -> dict[str, Parameter]:
        """Parameter declarations by name."""
        return declared_fields(self.parameters, Parameter)

    @property
    def state_declarations(self) -> dict[str, StateVariable]:
        """State variable declarations by name."""
        return declared_fields(self.state, StateVariable)

    @property
    def source_file(self) -> Path:
        """The file that defines the law."""
        return Path(inspect.getfile(self.update))

    @property
    def documentation(self) -> str:
        """The header of the law's file: equations, source, conventions, range of validity."""
        return inspect.getdoc(inspect.getmodule(self.update)) or ""


def check_law(law: Law) -> None:
    """Refuse a law that cannot be trusted at all, raising DeclarationError with the reason.

    Checks the name, the hook version, every declaration and one step of every named parameter set in plain Python.
    """
    if not re.fullmatch(r"[a-z][a-z0-9_]*", law.name):
        raise DeclarationError(f"the name '{law.name}' is not lower_case_with_underscores")
    _check_hook_version(law)
    if not law.summary.strip():
        raise DeclarationError("no summary")
    declared_fields(law.parameters, Parameter)
    state_variables = declared_fields(law.state, StateVariable)
    for name in law.lower_bounds:
        if name not in state_variables:
            raise DeclarationError(f"lower_bounds names '{name}', which is no state variable")
    for name, parameter_set in law.parameter_sets.items():
        _check_one_step(law, name, parameter_set)


def _check_hook_version(law: Law) -> None:
    written_for = law.hook_version
    if isinstance(written_for, bool) or not isinstance(written_for, int):
        raise DeclarationError(f"hook_version = {written_for!r} is not a whole number")
    understood = f"this grainlaw understands {OLDEST_HOOK_VERSION} to {HOOK_VERSION}"
    if written_for > HOOK_VERSION:
        raise DeclarationError(f"written for hook version {written_for}; {understood}: it needs a newer grainlaw")
    if written_for < OLDEST_HOOK_VERSION:
        raise DeclarationError(
            f"written for hook version {written_for}; {understood}: the law has to be brought up to date"
        )
    for name in (
        "small_step",
        "stored_energy",
        "lower_bounds",
        "viscosity",
        "holds_in_single",
        "least_initial_pressure",
    ):
        if getattr(law, name) and written_for < STATEMENTS_VERSION:
            raise DeclarationError(
                f"{name} belongs to hook version {STATEMENTS_VERSION}; the law says hook_version={written_for}"
            )


def _check_one_step(law: Law, name: str, parameter_set: ParameterSet) -> None:
    parameters = parameter_set.parameters
    for parameter, declaration in law.parameter_declarations.items():
        value = getattr(parameters, parameter)
        if not declaration.interval.contains(value):
            raise DeclarationError(f"parameter set '{name}': {parameter} = {value} is outside {declaration.bounds}")
    if reason := law.inconsistency(parameters):
        raise DeclarationError(f"parameter set '{name}': {reason}")
    try:
        density = parameter_set.density(1000.0, parameters)
        stress = isotropic(-1000.0)
        state = law.initial_state(stress, density, parameters)
        strain_rate = SymmetricTensor(-1e-3, 1e-3, 0.0, 1e-3, 0.0, 0.0)
        stress, state = law.update(stress, strain_rate, density, state, parameters, 1e-5)
        numbers = [law.sound_speed(stress, density, state, parameters)]
        if law.stored_energy is not None:
            numbers.append(law.stored_energy(stress, density, state, parameters))
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        raise DeclarationError(f"one step with parameter set '{name}' raises {reason}") from error
    if not all(math.isfinite(value) for value in (*stress, *state, *numbers)):
        raise DeclarationError(f"one step with parameter set '{name}' gives a value that is not finite")
