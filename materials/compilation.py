"""Compiling a law: the same plain functions, made callable from njit code and cached on disk.

The disk cache of the compiler is keyed on the name and the file of the generated function and on what it closes over. A
compiled law therefore closes over its plain functions and carries in its name a mark of everything that they reach
(`reached`) and of all that is compiled around them: an edited law recompiles, an unedited one loads from disk.
"""

import hashlib
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from numba import njit
from numba.core.errors import NumbaError, UnsupportedBytecodeError
from numba.extending import intrinsic, overload, register_jitable

import grainlaw.materials.tensor_operators  # noqa: F401  the operators of SymmetricTensor
from grainlaw.materials.elementary import fused
from grainlaw.materials.errors import InputError
from grainlaw.materials.kernel_cache import use_kernel_cache
from grainlaw.materials.law import Law
from grainlaw.materials.pointwise import MARKED
from grainlaw.materials.reached import compiled_closures, digest_of_reached
from grainlaw.materials.single_precision import in_single

use_kernel_cache()

# Any of these may be compiled into a law or a kernel, or decide how that is done.
MATERIALS_FILES = tuple(Path(__file__).parent.glob("*.py"))
MARK_LENGTH = 14
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


def mark_of_sources(files: Iterable[Path]) -> str:
    """A mark for `named` that changes with the names and the content of files and of all of `materials`.

    The disk cache notices an edit of the file that holds a kernel, but not of what the kernel takes from other files.
    """
    digest = hashlib.sha256()
    for path in sorted({*files, *MATERIALS_FILES}):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:MARK_LENGTH]


def mark_of_reached(things: Iterable[object]) -> str:
    """A mark for `named` that changes with everything that functions and classes reach, and with all of `materials`."""
    text = digest_of_reached(things) + _materials_mark()
    return hashlib.sha256(text.encode()).hexdigest()[:MARK_LENGTH]


@cache
def _materials_mark() -> str:
    return mark_of_sources(())


@dataclass(frozen=True)
class PointwiseLaw:
    """A law's functions, callable from compiled code, and the mark of all that can change what they compile to.

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
    viscosity: Callable[..., Any] | None
    mark: str


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
def _name_by_values(closure: Any) -> None:
    """Name a closure that a law compiles itself by what it closes over, for the reason that `named` gives.

    The check of the law has called it already, under its old name.
    """
    named(mark_of_reached([closure]))(closure.py_func)
    closure.recompile()


def _parts(law: Law) -> list[Callable[..., Any]]:
    return [part for _, part in sorted(vars(law).items()) if callable(part)]


def mark_of_law(law: Law) -> str:
    """A mark that changes with everything that a law reaches: another law of the same name has another mark."""
    return digest_of_reached(_parts(law))


@cache
def pointwise_law(law: Law, precision: str = "double") -> PointwiseLaw:
    """The functions of a law in a precision, registered with the compiler."""
    _register_helpers()
    for kind in (law.parameters, law.state):
        _name_by_module(kind)
    register: Callable[..., Any] = in_single if precision == "single" else _register_marked
    parts = _parts(law)
    for closure in compiled_closures(parts):
        _name_by_values(closure)
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
        viscosity=_register_marked(law.viscosity) if law.viscosity is not None and law.viscosity_bounds_step else None,
        mark=f"{law.name}_{precision}_{mark_of_reached(parts)}",
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
