"""What compiled code can depend on: everything that some functions reach, by whatever way they name it.

Compiled code holds what its functions found when they were compiled: constants of their own module and of others,
attributes of modules and classes, cells of closures, default arguments, other functions. The digest is of the code and
of the values of all these, and of the source of every module in which they stand or which such a module imports. It
holds no paths: a copy of a file has the digest of the file.

Not looked into are Python's own library and the compiler with what it computes with. Of other installed packages, those
modules count whose functions or classes are reached, and what these import from their own package. Of grainlaw, imports
lead to laws only: `compilation` has all of `materials` in every mark, and laws need nothing else.
"""

import ast
import functools
import hashlib
import pickle
import sys
from collections.abc import Iterable, Iterator
from enum import Enum
from functools import cache
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

_NOT_LOOKED_INTO = {"llvmlite", "numba", "numpy", "scipy"} | sys.stdlib_module_names
_INSTALLED = {"site-packages", "dist-packages"}
_CONSTANT = (tuple, frozenset, CodeType, np.generic)
_PLAIN = (bool, int, float, complex, str, bytes, type(None), type(Ellipsis), range, slice)


def digest_of_reached(things: Iterable[object]) -> str:
    """A digest of all that functions, classes and values reach."""
    walk = _Walk()
    for thing in things:
        walk.visit(thing, frozenset())
    return walk.finished()


def compiled_closures(things: Iterable[object]) -> list[Any]:
    """The functions reached that are compiled by themselves (`njit`) and close over values."""
    walk = _Walk()
    for thing in things:
        walk.visit(thing, frozenset())
    return walk.compiled_closures


class _Walk:
    """A walk over what is reached, each thing once, in an order that is the same in every process."""

    def __init__(self) -> None:
        self._digest = hashlib.sha256()
        self._seen: dict[Any, int] = {}
        # An id is that of one object only as long as the object lives.
        self._alive: list[object] = []
        self._modules: set[str] = set()
        self.compiled_closures: list[Any] = []

    def finished(self) -> str:
        for name in sorted(_with_imports(self._modules)):
            self._note(name, _digest_of_file(_file(name)))
        return self._digest.hexdigest()

    def visit(self, value: object, names: frozenset[str]) -> None:
        """Take in a value; `names` are those that the code which reached it may ask for as attributes."""
        if isinstance(value, _PLAIN) and not isinstance(value, Enum):
            self._note(type(value).__name__, repr(value))
        elif not self._is_known(value, names):
            self._visit_new(value, names)

    def _visit_new(self, value: Any, names: frozenset[str]) -> None:  # noqa: C901, PLR0912
        self._note(type(value).__name__)
        if isinstance(value, ModuleType):
            self._visit_module(value, names)
        elif isinstance(value, type):
            self._visit_class(value)
        elif isinstance(value, FunctionType):
            self._visit_function(value)
        elif isinstance(value, CodeType):
            self._visit_code(value)
        elif isinstance(value, BuiltinFunctionType):
            self._note(value.__module__, value.__qualname__)
        elif isinstance(value, np.ndarray | np.generic):
            self._note(value.dtype.str, value.shape, value.tobytes())
        elif isinstance(value, Enum):
            self._visit_all((type(value), value.name, value.value))
        elif isinstance(value, tuple | list):
            self._visit_all((type(value), len(value), *value))
        elif isinstance(value, set | frozenset):
            self._visit_all(sorted(value, key=repr))
        elif isinstance(value, dict):
            self._visit_all(part for item in value.items() for part in item)
        elif isinstance(value, MethodType):
            self._visit_all((value.__func__, value.__self__))
        elif isinstance(value, staticmethod | classmethod):
            self.visit(value.__func__, names)
        elif isinstance(value, property):
            self._visit_all((value.fget,))
        elif isinstance(value, functools.partial):
            self._visit_all((value.func, value.args, value.keywords))
        elif isinstance(inner := _wrapped(value), FunctionType):
            if inner.__closure__ and hasattr(value, "recompile"):
                self.compiled_closures.append(value)
            self.visit(inner, names)
        else:
            self._visit_other(value)

    def _visit_all(self, values: Iterable[object]) -> None:
        for value in values:
            self.visit(value, frozenset())

    def _visit_module(self, module: ModuleType, names: frozenset[str]) -> None:
        self._note(module.__name__)
        if _is_looked_into(module.__name__):
            self._modules.add(module.__name__)
            self._visit_named(vars(module), names)

    def _visit_class(self, kind: type[Any]) -> None:
        # Pickles in the disk cache refer to a class by its module.
        self._note(kind.__module__, kind.__qualname__)
        if not _is_looked_into(kind.__module__):
            return
        self._modules.add(kind.__module__)
        self._visit_all(kind.__bases__)
        own = vars(kind)
        self._visit_all((own.get("_fields"), own.get("_field_defaults")))
        self._visit_named(own, frozenset(name for name in own if not name.startswith("_")))

    def _visit_function(self, function: FunctionType) -> None:
        # `compilation` changes the name of some functions, but not of their code.
        self._note(function.__module__, function.__code__.co_qualname)
        if not _is_looked_into(function.__module__):
            return
        self._modules.add(function.__module__)
        self.visit(function.__code__, frozenset())
        names = frozenset(_names(function.__code__))
        self._visit_named(function.__globals__, names)
        for cell in function.__closure__ or ():
            try:
                content = cell.cell_contents
            except ValueError:
                continue
            self.visit(content, names)
        self._visit_all((function.__defaults__, function.__kwdefaults__))

    def _visit_code(self, code: CodeType) -> None:
        variables = code.co_varnames, code.co_freevars, code.co_cellvars
        self._note(code.co_code, code.co_names, variables, code.co_argcount, code.co_kwonlyargcount, code.co_flags)
        self._visit_all(code.co_consts)

    def _visit_named(self, known: Any, names: frozenset[str]) -> None:
        for name in sorted(names & known.keys()):
            self._note(name)
            self.visit(known[name], names)

    def _visit_other(self, value: object) -> None:
        self.visit(type(value), frozenset())
        try:
            self._note(pickle.dumps(value, protocol=4))
        except Exception:  # what cannot be pickled stands for its class alone
            self._note(type(value).__qualname__)

    def _is_known(self, value: object, names: frozenset[str]) -> bool:
        # Whether equal constants are one object depends on how the code was loaded.
        if isinstance(value, _CONSTANT):
            return False
        key = (id(value), names) if isinstance(value, ModuleType) else id(value)
        if key in self._seen:
            self._note("again", self._seen[key])
            return True
        self._seen[key] = len(self._seen)
        self._alive.append(value)
        return False

    def _note(self, *parts: object) -> None:
        self._digest.update(repr(parts).encode())


def _wrapped(value: object) -> object:
    """The plain function behind a compiled or decorated one."""
    return getattr(value, "py_func", None) or getattr(value, "__wrapped__", None)


def _names(code: CodeType) -> Iterator[str]:
    """All that code may ask for as a global or an attribute, code within it included."""
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)
        elif isinstance(constant, str):
            yield constant


def _is_looked_into(module: str | None) -> bool:
    return module is not None and _top(module) not in _NOT_LOOKED_INTO


def _file(module: str) -> Path | None:
    """The Python source of a module that is loaded."""
    found = getattr(sys.modules.get(module), "__file__", None)
    path = Path(found) if found else None
    return path if path and path.suffix == ".py" and path.is_file() else None


def _with_imports(modules: Iterable[str]) -> set[str]:
    """These modules and all that they import when they are loaded, directly or not."""
    found: set[str] = set()
    pending = list(modules)
    while pending:
        module = pending.pop()
        if module not in found:
            found.add(module)
            pending.extend(_followed_imports(module))
    return found


def _followed_imports(module: str) -> Iterator[str]:
    path = _file(module)
    if path is None:
        return
    package = getattr(sys.modules[module], "__package__", None) or ""
    for name in _imported(path, _stamp(path), package):
        other = _file(name) if _is_looked_into(name) and _is_followed(name) else None
        if other and (_top(name) == _top(module) or not _INSTALLED & set(other.parts)):
            yield name


def _is_followed(module: str) -> bool:
    return _top(module) != "grainlaw" or module.startswith("grainlaw.plugins.")


def _top(module: str) -> str:
    return module.partition(".")[0]


def _digest_of_file(path: Path | None) -> str:
    return _digest_of_content(path, _stamp(path)) if path else ""


def _stamp(path: Path) -> tuple[int, int]:
    status = path.stat()
    return status.st_mtime_ns, status.st_size


@cache
def _digest_of_content(path: Path, stamp: tuple[int, int]) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@cache
def _imported(path: Path, stamp: tuple[int, int], package: str) -> tuple[str, ...]:
    """Names that a file's imports may mean a module by; those within functions happen at other times or never."""
    found: list[str] = []
    pending: list[ast.AST] = [ast.parse(path.read_bytes())]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Import):
            found.extend(prefix for alias in node.names for prefix in _prefixes(alias.name))
        elif isinstance(node, ast.ImportFrom):
            base = _absolute(node, package)
            found.extend([*_prefixes(base), *(f"{base}.{alias.name}" for alias in node.names)])
        elif not isinstance(node, ast.FunctionDef | ast.expr) and not _is_for_type_checkers(node):
            pending.extend(ast.iter_child_nodes(node))
    return tuple(found)


def _absolute(node: ast.ImportFrom, package: str) -> str:
    if not node.level:
        return node.module or ""
    base = package.split(".")[: len(package.split(".")) - node.level + 1]
    return ".".join([*base, *([node.module] if node.module else [])])


def _prefixes(name: str) -> list[str]:
    parts = name.split(".")
    return [".".join(parts[: count + 1]) for count in range(len(parts))]


def _is_for_type_checkers(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
