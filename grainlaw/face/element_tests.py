"""Element tests for scripts and notebooks: one point of a law, its history as arrays, table and picture."""

from collections.abc import Mapping
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.face.tables import data_frame
from grainlaw.materials.element.catalogue import MIXED, get_element_test
from grainlaw.materials.element.mixed import mixed_test, read_control
from grainlaw.materials.element.result import ElementResult
from grainlaw.materials.element.run import run_element_test as run_prepared
from grainlaw.materials.element.settings import ElementTest
from grainlaw.materials.element.specimen import prepared
from grainlaw.materials.errors import InputError, nearest_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame


class ElementTestResult:
    """The history of one point under an element test; `result["pressure"]` is a quantity over time."""

    def __init__(self, history: ElementResult) -> None:
        self.history = history
        """The points of the history, and what was computed of them."""

    @property
    def parameters(self) -> dict[str, float]:
        """The values of the law's parameters by name, in SI units."""
        return dict(self.history.specimen.parameters._asdict())

    @property
    def settings(self) -> dict[str, float]:
        """The values of the test's settings by name, in SI units."""
        return dict(self.history.settings._asdict())

    @property
    def units(self) -> dict[str, str]:
        """The SI unit of each quantity by name."""
        return {column.name: column.unit for column in self.history.columns}

    def to_dict(self) -> dict[str, NDArray[np.float64]]:
        """Each quantity over time by name: stress, strain, density, pressure, state variables, ...; shape (times,)."""
        return {column.name: column.values for column in self.history.columns}

    def to_frame(self) -> "DataFrame":
        """The same as a pandas table, with the units in its `attrs`. Raises InputError without pandas."""
        return data_frame(self.to_dict(), self.units)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        quantities = self.to_dict()
        if name not in quantities:
            raise KeyError(f"no quantity '{name}'; {nearest_name(name, quantities)}")
        return quantities[name]

    def plot(self, *others: "ElementTestResult", path: str | Path | None = None) -> "Figure":
        """The four panels of the paper's Figure 1, with other materials in the same test; written to `path` as PNG."""
        from grainlaw.face.figure import NotebookFigure
        from grainlaw.materials.element.figures import SIZE, draw_on, write

        figure = NotebookFigure(figsize=SIZE, layout="constrained")
        draw_on(figure, [self.history, *(other.history for other in others)])
        if path is not None:
            write(figure, Path(path))
        return figure

    def __repr__(self) -> str:
        history = self.history
        last = ", ".join(
            f"{column.name} = {column.values[-1]:.6g} {column.unit}"
            for column in history.columns
            if column.name in ("pressure", "deviatoric_stress", "density")
        )
        return f"{history.test} of {history.specimen.label}, {history.steps} steps; at the end {last}"


def chosen_test(name: str, control: Path | None) -> ElementTest:
    """The element test of that name; the test `mixed` follows the stages of a control file.

    Raises InputError for an unknown name, and for a control file too many or too few.
    """
    if name != MIXED:
        found = get_element_test(name)
        if control:
            raise InputError(f"a control file (--control) belongs to the element test {MIXED}, not to {name}")
        return found
    if control is None:
        raise InputError(f"the element test {MIXED} needs a control file (--control FILE.toml)")
    return mixed_test(read_control(control))


def run_element_test(
    law: str,
    test: str,
    parameter_set: str | Path | None,
    control: str | Path | None,
    values: Mapping[str, Any],
) -> ElementTestResult:
    """Run an element test on the law of that name; see `ConstitutiveLaw.element_test`."""
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, Real):
            raise InputError(f"{name} = {value!r}: a number is needed")
    chosen = chosen_test(test, None if control is None else Path(control))
    specimen, settings = prepared(law, parameter_set, values, chosen)
    specimen.warn_about_density(settings.initial_pressure, settings.density)
    return ElementTestResult(run_prepared(chosen, specimen, settings))
