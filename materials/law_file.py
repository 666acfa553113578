"""Importing a law from a file of its own, which may import files beside it.

Each file is a module whose name holds a digest of its content and of that of the files beside it that it imports,
directly or not. The compiler's disk cache refers to classes by module and name: a name has to be the same in every
process, and two files that differ, or whose neighbours do, must not share one. So `import tables` in a law's file means
the `tables.py` beside it, as a module of that longer name; no other code sees a module `tables`.
"""

import ast
import hashlib
import importlib
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import find_spec, spec_from_file_location
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

PREFIX = "grainlaw_plugin"


def import_law_file(path: Path) -> ModuleType:
    """The module of a file; of a file that was imported before, with the same neighbours, the same module.

    Raises FileNotFoundError, and ImportError where an import may mean a file beside it as well as an installed module.
    """
    if not path.is_file():
        raise FileNotFoundError(f"no file {path}")
    files = _with_neighbours(path.resolve())
    names = {file.path: _module_name(file, files) for file in files.values()}
    for file in files.values():
        modules = {name: names[beside] for name, beside in file.beside.items()}
        _FINDER.known.setdefault(names[file.path], _Renamed(file, modules))
    return importlib.import_module(names[path.resolve()])


@dataclass(frozen=True)
class _File:
    """A file as it was read, and the files beside it that it imports, by the names that it knows them by."""

    path: Path
    content: bytes
    beside: dict[str, Path]


def _with_neighbours(path: Path) -> dict[Path, _File]:
    """A file and all that it imports from its folder, directly or not."""
    found: dict[Path, _File] = {}
    pending = [path]
    while pending:
        path = pending.pop()
        if path not in found:
            content = path.read_bytes()
            found[path] = _File(path, content, dict(_imported_beside(path, content)))
            pending.extend(found[path].beside.values())
    return found


def _imported_beside(path: Path, content: bytes) -> Iterator[tuple[str, Path]]:
    for node in ast.walk(ast.parse(content, path)):
        for name in _names_that_may_stand_beside(node):
            beside = path.parent / f"{name}.py"
            if beside.is_file():
                _refuse_two_meanings(name, beside)
                yield name, beside


def _names_that_may_stand_beside(node: ast.AST) -> list[str]:
    """What a statement imports from where there are single files; `from .name import x` is one of these."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom) and node.level <= 1:
        return [node.module] if node.module else [alias.name for alias in node.names]
    return []


def _refuse_two_meanings(name: str, beside: Path) -> None:
    if name in sys.stdlib_module_names or name == __name__.partition(".")[0]:
        owner = "Python" if name in sys.stdlib_module_names else "this library"
        raise ImportError(f"'{name}' may mean {beside} or the module of {owner}; rename the file")
    try:
        spec = find_spec(name)
    except ValueError:
        return
    origin = Path(spec.origin) if spec and spec.origin else beside
    if origin.resolve() != beside and {"site-packages", "dist-packages"} & set(origin.parts):
        raise ImportError(f"'{name}' may mean {beside} or the installed {origin}; rename the file")


def _module_name(file: _File, files: dict[Path, _File]) -> str:
    digest = hashlib.sha256(file.content)
    reached, pending = {file.path}, [file.path]
    while pending:
        for path in files[pending.pop()].beside.values():
            if path not in reached:
                reached.add(path)
                pending.append(path)
    for path in sorted(reached - {file.path}):
        digest.update(path.name.encode() + b"\0" + files[path].content)
    stem = re.sub(r"\W", "_", file.path.stem)
    return f"{PREFIX}_{stem}_{digest.hexdigest()[:12]}"


class _Renamed(ast.NodeTransformer):
    """The tree of a file in which files beside it are imported by the names of their modules."""

    def __init__(self, file: _File, modules: dict[str, str]) -> None:
        self.file, self._modules = file, modules

    def tree(self) -> ast.Module:
        renamed: ast.Module = self.visit(ast.parse(self.file.content, self.file.path))
        return ast.fix_missing_locations(renamed)

    def visit_Import(self, node: ast.Import) -> ast.Import:
        return ast.copy_location(ast.Import([self._renamed(alias) for alias in node.names]), node)

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.stmt:
        if node.level <= 1 and node.module in self._modules:
            return ast.copy_location(ast.ImportFrom(self._modules[node.module], node.names, 0), node)
        if node.level == 1 and not node.module and all(alias.name in self._modules for alias in node.names):
            return ast.copy_location(ast.Import([self._renamed(alias) for alias in node.names]), node)
        return node

    def _renamed(self, alias: ast.alias) -> ast.alias:
        if alias.name not in self._modules:
            return alias
        return ast.copy_location(ast.alias(self._modules[alias.name], alias.asname or alias.name), alias)


class _Loader(SourceFileLoader):
    """Runs a file as it was read: compiled anew, since Python's own cache takes a quick edit for none."""

    def __init__(self, name: str, source: _Renamed) -> None:
        super().__init__(name, str(source.file.path))
        self._source = source

    def get_code(self, fullname: str) -> CodeType:
        return compile(self._source.tree(), self.path, "exec", dont_inherit=True)


class _Finder(MetaPathFinder):
    """Finds the modules of law files by their names, those beside them included."""

    def __init__(self) -> None:
        self.known: dict[str, _Renamed] = {}

    def find_spec(self, fullname: str, path: Sequence[str] | None, target: Any = None) -> ModuleSpec | None:
        source = self.known.get(fullname)
        if source is None:
            return None
        return spec_from_file_location(fullname, source.file.path, loader=_Loader(fullname, source))


_FINDER = _Finder()
sys.meta_path.append(_FINDER)
