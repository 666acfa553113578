"""Declarations of a law's parameters and state variables: the single source for checks, storage, output and docs.

A law declares each quantity once, as an annotated field of a NamedTuple:

    class Parameters(NamedTuple):
        bulk_modulus: Annotated[float, Parameter("Pa", "bulk modulus K", "(0, inf)")]
"""

import math
import re
from dataclasses import dataclass
from typing import Any, get_type_hints

from grainlaw.materials.errors import InputError, nearest_name

BASE_UNITS = ("1", "m", "kg", "s", "Pa", "N", "J", "K", "rad")
_FACTOR = rf"(?:{'|'.join(BASE_UNITS)})\d*"
_UNIT = re.compile(rf"{_FACTOR}(?:[./]{_FACTOR})*")
_INTERVAL = re.compile(r"([\[(])\s*([^,\s]+)\s*,\s*([^,\s]+)\s*([\])])")


class DeclarationError(InputError):
    """A declaration lacks its unit or doc, or does not make sense."""


@dataclass(frozen=True)
class Interval:
    """The values that a parameter may take."""

    lower: float
    upper: float
    lower_open: bool
    upper_open: bool

    @classmethod
    def parse(cls, text: str) -> "Interval":
        """Read the usual notation, for instance "(0, inf)" or "[0, 0.5)"."""
        match = _INTERVAL.fullmatch(text.strip())
        if match is None:
            raise DeclarationError(f"bounds '{text}' are no interval such as '(0, inf)' or '[0, 1]'")
        return cls(float(match[2]), float(match[3]), match[1] == "(", match[4] == ")")

    def contains(self, value: float) -> bool:
        """Whether the value lies in the interval; NaN and infinities never do."""
        above = value > self.lower if self.lower_open else value >= self.lower
        below = value < self.upper if self.upper_open else value <= self.upper
        return math.isfinite(value) and above and below


@dataclass(frozen=True)
class Parameter:
    """A material constant: SI unit, one-line doc, the interval of allowed values."""

    unit: str
    doc: str
    bounds: str = "(-inf, inf)"

    @property
    def interval(self) -> Interval:
        """The bounds as an interval."""
        return Interval.parse(self.bounds)


@dataclass(frozen=True)
class StateVariable:
    """A quantity that each point carries besides stress and density; `output` says whether it is written by default."""

    unit: str
    doc: str
    output: bool = True


Declaration = Parameter | StateVariable


def declared_fields(tuple_class: type[Any], kind: type[Declaration]) -> dict[str, Any]:
    """The declarations of a NamedTuple class by field name.

    Raises DeclarationError for a field without a declaration, without a doc or with a unit that is not SI.
    """
    hints = get_type_hints(tuple_class, include_extras=True)
    declarations = {}
    for name in tuple_class._fields:
        found = [item for item in getattr(hints[name], "__metadata__", ()) if isinstance(item, kind)]
        if len(found) != 1:
            raise DeclarationError(f"'{name}' is not declared: annotate it as Annotated[float, {kind.__name__}(...)]")
        _check_declaration(name, found[0])
        declarations[name] = found[0]
    return declarations


def _check_declaration(name: str, declaration: Declaration) -> None:
    if not declaration.unit:
        raise DeclarationError(f"'{name}' declares no unit (a number without dimension has the unit '1')")
    if not _UNIT.fullmatch(declaration.unit):
        raise DeclarationError(
            f"'{name}' declares the unit '{declaration.unit}'; allowed are products and quotients of "
            f"{', '.join(BASE_UNITS)} such as 'kg/m3' or 'Pa.s'"
        )
    if not declaration.doc.strip():
        raise DeclarationError(f"'{name}' declares no doc")
    if isinstance(declaration, Parameter):
        try:
            _ = declaration.interval
        except DeclarationError as error:
            raise DeclarationError(f"'{name}': {error}") from None


def checked_parameters(law_name: str, tuple_class: type[Any], values: dict[str, Any]) -> Any:
    """The parameters of a law as its NamedTuple, from values by name.

    Raises InputError for an unknown, missing, non-numeric or out-of-bounds value.
    """
    declarations = declared_fields(tuple_class, Parameter)
    for name in values:
        if name not in declarations:
            raise InputError(f"{law_name} has no parameter '{name}'; {nearest_name(name, declarations)}")
    missing = [name for name in declarations if name not in values and name not in tuple_class._field_defaults]
    if missing:
        wanted = ", ".join(f"{name} [{declarations[name].unit}]" for name in missing)
        raise InputError(f"{law_name} needs a value for: {wanted}")
    complete = {**tuple_class._field_defaults, **values}
    for name, value in complete.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{law_name}.{name} = {value!r} is not a number")
        if not declarations[name].interval.contains(value):
            unit = "" if declarations[name].unit == "1" else f" {declarations[name].unit}"
            allowed = f"{declarations[name].bounds}{unit}"
            raise InputError(f"{law_name}.{name} = {value} is out of bounds; allowed: {allowed}")
    return tuple_class(**{name: float(complete[name]) for name in tuple_class._fields})
