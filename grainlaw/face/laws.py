"""The laws for scripts and notebooks: listing them, and one of them with what it declares."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from grainlaw.face.display import html_table, text_table
from grainlaw.materials.declarations import Parameter, StateVariable
from grainlaw.materials.errors import InputError
from grainlaw.materials.law import Law, ParameterSet
from grainlaw.materials.registry import RegisteredLaw, registry

if TYPE_CHECKING:
    from grainlaw.face.element_tests import ElementTestResult


@dataclass(frozen=True, repr=False)
class ConstitutiveLaw:
    """A law with what it declares, and its element tests.

    definition  the law's functions and declarations, as its file gives them
    origin      the package and version, or the file, that the law came from
    """

    definition: Law
    origin: str

    @property
    def name(self) -> str:
        """The name by which scenes and the command line call the law."""
        return self.definition.name

    @property
    def summary(self) -> str:
        """The law in one line."""
        return self.definition.summary

    @property
    def documentation(self) -> str:
        """The header of the law's file: equations, source, conventions, range of validity."""
        return self.definition.documentation

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Unit, meaning and bounds of each parameter, by name."""
        return self.definition.parameter_declarations

    @property
    def state_variables(self) -> dict[str, StateVariable]:
        """Unit and meaning of each state variable, by name."""
        return self.definition.state_declarations

    @property
    def parameter_sets(self) -> "ParameterSets":
        """The named parameter sets: their values and the source of these; the first is what element tests take."""
        return ParameterSets(self.definition)

    def element_test(
        self,
        test: str,
        /,
        *,
        parameter_set: str | Path | None = None,
        control: str | Path | None = None,
        **values: float,
    ) -> "ElementTestResult":
        """Lead one point of the law along the path of an element test, such as "simple-shear".

        parameter_set  one of the law's parameter sets, or a TOML file of values; by default the law's first set
        control        the TOML file of stages that the test "mixed" follows
        values         parameters of the law and settings of the test, in SI units

        Raises InputError for an unknown test, set or name and a value out of bounds, SimulationError where the test
        cannot be followed to its end.
        """
        if registry().get(self.name).law is not self.definition:
            raise InputError(f"{self.name} was loaded again since; take it anew with gl.law")

        from grainlaw.face.element_tests import run_element_test

        return run_element_test(self.name, test, parameter_set, control, values)

    def __repr__(self) -> str:
        lines = [f"{self.name}: {self.summary}", f"from {self.origin}", "", text_table(*self._parameter_table())]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return f"<p><b>{self.name}</b>: {self.summary}</p>" + html_table(*self._parameter_table())

    def _parameter_table(self) -> tuple[list[str], list[list[str]]]:
        sets = self.parameter_sets
        rows = [
            [name, declared.unit, declared.bounds, *sets.values_of(name), declared.doc]
            for name, declared in self.parameters.items()
        ]
        return ["parameter", "unit", "bounds", *sets, "meaning"], rows


class ParameterSets(Mapping[str, ParameterSet]):
    """The named parameter sets of a law; shown as a table of their values, with the source of each."""

    def __init__(self, definition: Law) -> None:
        self._definition = definition

    def __getitem__(self, name: str) -> ParameterSet:
        return self._definition.parameter_sets[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._definition.parameter_sets)

    def __len__(self) -> int:
        return len(self._definition.parameter_sets)

    def values_of(self, parameter: str) -> list[str]:
        """The value of a parameter in each set, as text."""
        return [f"{getattr(found.parameters, parameter):g}" for found in self.values()]

    def __repr__(self) -> str:
        return "\n".join([text_table(*self._table()), *self._sources()])

    def _repr_html_(self) -> str:
        return html_table(*self._table()) + "".join(f"<p>{source}</p>" for source in self._sources())

    def _table(self) -> tuple[list[str], list[list[str]]]:
        declared = self._definition.parameter_declarations
        return ["parameter", "unit", *self], [
            [name, found.unit, *self.values_of(name)] for name, found in declared.items()
        ]

    def _sources(self) -> list[str]:
        return [f"{name}: {found.source}" for name, found in self.items()]


class Laws(Mapping[str, ConstitutiveLaw]):
    """The laws that are known, by name; shown as a table."""

    def __init__(self, entries: Mapping[str, RegisteredLaw], refusals: list[str]) -> None:
        self._laws = {name: ConstitutiveLaw(entry.law, entry.origin) for name, entry in sorted(entries.items())}
        self.refusals = refusals
        """What was not accepted as a law, and why."""

    def __getitem__(self, name: str) -> ConstitutiveLaw:
        return self._laws[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._laws)

    def __len__(self) -> int:
        return len(self._laws)

    def __repr__(self) -> str:
        return "\n".join([text_table(*self._table()), *self.refusals])

    def _repr_html_(self) -> str:
        return html_table(*self._table()) + "".join(f"<p>{refusal}</p>" for refusal in self.refusals)

    def _table(self) -> tuple[list[str], list[list[str]]]:
        rows = [
            [name, found.summary, ", ".join(found.parameter_sets), found.origin] for name, found in self._laws.items()
        ]
        return ["law", "summary", "parameter sets", "from"], rows


def laws() -> Laws:
    """The laws that are known: built in, of installed packages, and of files loaded in this process."""
    known = registry()
    return Laws(known.laws, [str(refusal) for refusal in known.refusals])


def law(source: str | Path) -> ConstitutiveLaw:
    """A law by its name, or the law of a Python file (a Path, or a text that ends in .py).

    Raises InputError, with the nearest name, for an unknown law; for a file that is refused, and for one that holds
    several laws: load it with `load_plugin` and take one by name.
    """
    if not _is_file(source):
        found = registry().get(str(source))
        return ConstitutiveLaw(found.law, found.origin)
    held = load_plugin(source)
    if len(held) > 1:
        raise InputError(f"{source} holds {len(held)} laws: {', '.join(held)}; take one of them from gl.load_plugin")
    return next(iter(held.values()))


def load_plugin(path: str | Path) -> Laws:
    """Register the laws of a Python file, in place of those that an earlier state of the file gave; return them.

    Raises InputError if the file or any of its laws is refused.
    """
    known, origin = registry(), str(Path(path))
    earlier = {name: entry for name, entry in known.laws.items() if entry.origin == origin}
    for name in earlier:
        del known.laws[name]
    try:
        known.load_file(Path(path))
    except InputError:
        known.laws.update(earlier)
        raise
    return Laws({name: entry for name, entry in known.laws.items() if entry.origin == origin}, [])


def _is_file(source: Any) -> bool:
    return isinstance(source, Path) or str(source).endswith(".py")
