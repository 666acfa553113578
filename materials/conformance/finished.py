"""What is left to write in a law: parameters that its update does not use, and lines of its file that say so."""

import re
from collections.abc import Iterator
from inspect import getmodule
from types import CodeType, FunctionType
from typing import Any

from grainlaw.materials import Law, isotropic
from grainlaw.materials.conformance.outcome import Outcome
from grainlaw.materials.conformance.subject import Subject

_REMARK = re.compile(r"\bTODO\b|\bFIXME\b|\bto be (written|completed)\b|\blaw to complete\b")
# Runs read these themselves, for the solid fraction and the inertial number.
_OF_GRAINS = {"grain_density", "grain_diameter"}
# They say something about the law; what it answers does not come from them.
_STATEMENTS = ("sound_speed", "viscosity", "stored_energy", "inconsistency")


def finished(subject: Subject) -> Outcome:
    """The law uses all parameters that it declares."""
    unused = unused_parameters(subject)
    if unused:
        return Outcome("FAIL", f"declared, but not used by `update`: {', '.join(unused)}")
    count = len(remarks(subject.law))
    return Outcome("pass", "every parameter is used" + (f"; left to write by its file: {count}" if count else ""))


def unfinished(law: Law) -> list[str]:
    """What is left to write, a line for each thing."""
    unused = unused_parameters(Subject(law, next(iter(law.parameter_sets)), 1)) if law.parameter_sets else []
    return [*(f"parameter {name} is declared, but update does not use it" for name in unused), *remarks(law)]


def remarks(law: Law) -> list[str]:
    """The lines of the law's file that say that something is to be written."""
    lines = enumerate(law.source_file.read_text(encoding="utf-8").splitlines(), start=1)
    return [f"{law.source_file.name}, line {number}: {line.strip()}" for number, line in lines if _REMARK.search(line)]


def unused_parameters(subject: Subject) -> list[str]:
    """Declared parameters that no function names but those that state something, and that no update reads."""
    law = subject.law
    left = law.parameter_declarations.keys() - _OF_GRAINS - set(_named(law))
    if left:
        left -= _read(subject)
    return sorted(left)


def _named(law: Law) -> Iterator[str]:
    """What the functions of the law's file, and what they call or close over, may ask for as attributes."""
    pending: list[object] = [*vars(getmodule(law.update)).values(), law.update, law.initial_state]
    seen = {getattr(law, name) for name in _STATEMENTS}
    while pending:
        function = pending.pop()
        if isinstance(function, FunctionType) and function not in seen:
            seen.add(function)
            yield from _names(function.__code__)
            pending += _called(function)


def _called(function: FunctionType) -> list[object]:
    """The functions of laws and their families that a function names or closes over."""
    reached = [function.__globals__.get(name) for name in _names(function.__code__)]
    reached += [cell.cell_contents for cell in function.__closure__ or ()]
    return [one for one in reached if not str(getattr(one, "__module__", "")).startswith("grainlaw.materials")]


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


def _read(subject: Subject) -> set[str]:
    """The parameters that density, initial state and updates along the paths of the subject read."""
    law, read = subject.law, set[str]()
    parameters = _recording(subject.parameters, read)
    subject.parameter_set.density(subject.pressure, parameters)
    law.initial_state(isotropic(-subject.pressure), subject.at_rest(subject.pressure).density, parameters)
    for call in subject.calls:
        law.update(call.start.stress, call.strain_rate, call.end.density, call.start.state, parameters, call.dt)
    return read


def _recording(parameters: Any, read: set[str]) -> Any:
    """The same values, which note the names under which they are read."""
    kind = type(parameters)

    class Recording(kind):  # type: ignore[misc, valid-type]
        def __getattribute__(self, name: str) -> Any:
            read.add(name)
            return super().__getattribute__(name)

        def __iter__(self) -> Iterator[Any]:
            read.update(kind._fields)
            return iter(parameters)

        def __getitem__(self, index: Any) -> Any:
            read.update(kind._fields)
            return parameters[index]

    return Recording(*parameters)
