"""Finding laws: one pluggy hook for built-ins, installed packages and single files alike."""

from dataclasses import dataclass
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType

import pluggy

from grainlaw.materials.errors import InputError, nearest_name
from grainlaw.materials.law import Law, check_law
from grainlaw.materials.law_file import import_law_file

PROJECT = "grainlaw"
ENTRY_POINT_GROUP = "grainlaw.materials"

hookspec = pluggy.HookspecMarker(PROJECT)
hookimpl = pluggy.HookimplMarker(PROJECT)


class MaterialHooks:
    """The hooks that a plugin may implement."""

    @hookspec
    def grainlaw_materials(self) -> list[Law]:  # type: ignore[empty-body]
        """Return the constitutive laws that this plugin provides; called once, at start-up."""


@dataclass(frozen=True)
class RegisteredLaw:
    """A law and the plugin that it came from."""

    law: Law
    origin: str


@dataclass(frozen=True)
class Refusal:
    """A plugin or law that was not accepted, and why."""

    name: str
    origin: str
    reason: str

    def __str__(self) -> str:
        return f"refused '{self.name}' from {self.origin}: {self.reason}"


class Registry:
    """The laws known to this process, by name."""

    def __init__(self) -> None:
        self.laws: dict[str, RegisteredLaw] = {}
        self.refusals: list[Refusal] = []

    def load_entry_points(self) -> None:
        """Register every installed plugin; a broken one is refused by name and the rest keeps working."""
        for entry_point in sorted(entry_points(group=ENTRY_POINT_GROUP), key=lambda found: found.name):
            package = entry_point.dist
            origin = f"{package.name} {package.version}" if package else entry_point.value
            try:
                module = entry_point.load()
            except Exception as error:
                self._refuse(entry_point.name, origin, f"import raises {type(error).__name__}: {error}")
                continue
            self._register_plugin(module, entry_point.name, origin)

    def load_file(self, path: Path) -> None:
        """Register the laws of one Python file. Raises InputError if the file or any of its laws is refused."""
        known_refusals = len(self.refusals)
        try:
            module = import_law_file(path)
        except Exception as error:
            raise InputError(f"plugin {path}: import raises {type(error).__name__}: {error}") from error
        self._register_plugin(module, path.stem, str(path))
        for refusal in self.refusals[known_refusals:]:
            raise InputError(f"plugin {path}: law '{refusal.name}': {refusal.reason}")

    def get(self, name: str) -> RegisteredLaw:
        """The law of that name. Raises InputError, with the nearest name or the reason of its refusal."""
        if name in self.laws:
            return self.laws[name]
        for refusal in self.refusals:
            if refusal.name == name:
                raise InputError(str(refusal))
        hint = "a law in a file of its own needs --plugin FILE.py, in Python gl.load_plugin"
        raise InputError(f"unknown law '{name}'; {nearest_name(name, self.laws)} ({hint})")

    def _register_plugin(self, module: ModuleType, name: str, origin: str) -> None:
        # One manager per plugin: an exception in one hook then stops no other plugin.
        manager = pluggy.PluginManager(PROJECT)
        manager.add_hookspecs(MaterialHooks)
        try:
            manager.register(module, name)
            # A hook that this version does not know: misspelt, or of a later version.
            manager.check_pending()
            laws = [law for found in manager.hook.grainlaw_materials() for law in found]
        except Exception as error:
            self._refuse(name, origin, f"hook grainlaw_materials raises {type(error).__name__}: {error}")
            return
        if not laws:
            self._refuse(name, origin, "it implements no hook grainlaw_materials that returns laws")
        for law in laws:
            self._register_law(law, name, origin)

    def _register_law(self, law: Law, plugin_name: str, origin: str) -> None:
        if not isinstance(law, Law):
            self._refuse(plugin_name, origin, f"grainlaw_materials returned {type(law).__name__}, not a Law")
            return
        if law.name in self.laws:
            self._refuse(law.name, origin, f"the name is taken by {self.laws[law.name].origin}")
            return
        try:
            check_law(law)
        except Exception as error:
            self._refuse(law.name, origin, str(error))
            return
        self.laws[law.name] = RegisteredLaw(law, origin)

    def _refuse(self, name: str, origin: str, reason: str) -> None:
        self.refusals.append(Refusal(name, origin, reason))


@cache
def registry() -> Registry:
    """The registry of this process, filled from the installed plugins at the first call."""
    found = Registry()
    found.load_entry_points()
    return found


def get_material(name: str) -> Law:
    """The law registered under a name. Raises InputError with the nearest valid name."""
    return registry().get(name).law
