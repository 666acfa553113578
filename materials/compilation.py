"""Compiling a law: the same plain functions, made callable from njit code and cached on disk.

The disk cache of the compiler is keyed on the name and the file of the generated function and on what it closes over. A
compiled law therefore closes over its plain functions and carries in its name a hash of every source that they call: an
edited law recompiles, an unedited one loads from disk.
"""

import hashlib
import inspect
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from numba import njit
from numba.core.errors import NumbaError, UnsupportedBytecodeError
from numba.extending import intrinsic, overload, register_jitable

from grainlaw.materials.elementary import fused
from grainlaw.materials.errors import InputError
from grainlaw.materials.law import Law
from grainlaw.materials.pointwise import MARKED
from grainlaw.materials.single_precision import in_single

_CAUSE = re.compile(r"Untyped global|Unknown attribute|NameError|nsupported|not supported|Cannot unify|Invalid use")


@intrinsic
def _rounded_once(typing_context: Any, a: Any, b: Any, c: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fma(*arguments)

    return a(a, a, a), generate


# Written out, it is the same in every compilation. A licence for the compiler to fuse where it likes (`fastmath`) is
# not, and runs would no longer repeat bit for bit.
@overload(fused, jit_options={"forceinline": True})
def _choose_fused(a, b, c):  # type: ignore[no-untyped-def]
    return lambda a, b, c: _rounded_once(a, b, c)  # type: ignore[call-arg]  # noqa: PLW0108


@cache
def _register_marked(function: Callable[..., Any]) -> Callable[..., Any]:
    return register_jitable(forceinline=True)(function)


def _register_helpers() -> None:
    for function in MARKED:
        _register_marked(function)


def named(mark: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Give a generated function a name of its own.

    The compiler links by name and argument types. Two functions that are generated from the same source and differ only
    in what they close over would be taken for one another once both come from the disk cache.
    """

    def rename(function: Callable[..., Any]) -> Callable[..., Any]:
        function.__name__ = f"{function.__name__}_{mark}"
        function.__qualname__ = f"{function.__qualname__}_{mark}"
        return function

    return rename


def mark_of_sources(files: Iterable[Path], modules: Iterable[str] = ()) -> str:
    """A mark for `named` that changes with the content of the files and the names of the modules.

    The disk cache notices an edit of the file that holds a kernel, but not of what the kernel takes from other files.
    It refers to NamedTuples by the modules that define them: what another module with the same content has left there
    cannot be read.
    """
    digest = hashlib.sha256(repr(sorted(modules)).encode())
    for path in sorted(files):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:14]


@dataclass(frozen=True)
class PointwiseLaw:
    """A law's functions, callable from compiled code, and the mark of all the sources behind them.

    The precision is that of the numbers that `update`, `sound_speed` and `small_step` take and return; the others take
    doubles.
    """

    name: str
    precision: str
    parameters: type[Any]
    state: type[Any]
    initial_state: Callable[..., Any]
    update: Callable[..., Any]
    sound_speed: Callable[..., Any]
    small_step: Callable[..., Any] | None
    stored_energy: Callable[..., Any] | None
    mark: str


def _source_files(functions: Iterable[Callable[..., Any]]) -> set[Path]:
    """The files of these functions and of every marked function that they call, directly or not."""
    marked = set(MARKED)
    files: set[Path] = set()
    seen: set[Callable[..., Any]] = set()
    pending = list(functions)
    while pending:
        function = pending.pop()
        if function in seen:
            continue
        seen.add(function)
        files.add(Path(inspect.getfile(function)))
        named = (function.__globals__.get(name) for name in function.__code__.co_names)
        pending.extend(found for found in named if inspect.isfunction(found) and found in marked)
    return files


def registered(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function marked with `pointwise`, made callable from compiled code."""
    _register_helpers()
    return _register_marked(function)


def _name_by_module(kind: type[Any]) -> None:
    """Name a NamedTuple by its module as well.

    The compiler takes unions of types of the same names for one another. What one law leaves in the disk cache would
    refer to the state of another, whose module the next process may not have.
    """
    kind.__name__ = f"{kind.__module__}.{kind.__qualname__}"


@cache
def pointwise_law(law: Law, precision: str = "double") -> PointwiseLaw:
    """The functions of a law in a precision, registered with the compiler."""
    _register_helpers()
    functions: list[Callable[..., Any]] = [law.initial_state, law.update, law.sound_speed]
    optional = [function for function in (law.small_step, law.stored_energy) if function is not None]
    modules = {law.parameters.__module__, law.state.__module__}
    for kind in (law.parameters, law.state):
        _name_by_module(kind)
    register: Callable[..., Any] = in_single if precision == "single" else _register_marked
    # What is computed around a law in double precision may be in single.
    files = _source_files([*functions, *optional]) | {Path(inspect.getfile(in_single))}
    return PointwiseLaw(
        name=law.name,
        precision=precision,
        parameters=law.parameters,
        state=law.state,
        initial_state=_register_marked(law.initial_state),
        update=register(law.update),
        sound_speed=register(law.sound_speed),
        small_step=register(law.small_step) if law.small_step is not None else None,
        stored_energy=_register_marked(law.stored_energy) if law.stored_energy is not None else None,
        mark=f"{law.name}_{precision}_{mark_of_sources(files, modules)}",
    )


def explained(law: Law, kernel: Callable[..., Any], *arguments: Any) -> Any:
    """Call a kernel, turning a compilation error into one line that names the law."""
    try:
        return kernel(*arguments)
    except (NumbaError, UnsupportedBytecodeError) as error:
        reason = _reason(error)
        raise InputError(f"law '{law.name}' ({law.source_file.name}) does not compile: {reason}") from error


def _reason(error: Exception) -> str:
    """The line of a compilation error that names the cause, or else its first line."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    causes = [line for line in lines if _CAUSE.search(line)]
    return (causes or lines or ["unknown reason"])[0]


def make_single_step(law: PointwiseLaw) -> Any:
    """One compiled update of one point, for tests that compare it with plain Python."""
    update = law.update

    @njit(cache=True)
    @named(law.mark)
    def single_step(stress, strain_rate, density, state, parameters, dt):  # type: ignore[no-untyped-def]
        return update(stress, strain_rate, density, state, parameters, dt)

    return single_step
