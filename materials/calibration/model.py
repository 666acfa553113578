"""The forward model of a fit: the answer of a law to the tests of all data files, and its distance from the data."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials import InputError, Law, checked_parameters
from grainlaw.materials.calibration.data import DataSet, Measured
from grainlaw.materials.calibration.quantities import QUANTITIES
from grainlaw.materials.element.result import ElementResult
from grainlaw.materials.element.specimen import Specimen

Array = NDArray[np.float64]
Values = dict[str, float]


@dataclass(frozen=True)
class ForwardModel:
    """A law and the data sets that it is compared with."""

    law: Law
    data: tuple[DataSet, ...]

    def history(self, data: DataSet, values: Values, abscissa: Array) -> ElementResult:
        """The element test of a data set, at these values of its first column and with these parameters of the law.

        Raises InputError for values that the law or the test refuses, SimulationError if the test breaks down.
        """
        of_law = {name: value for name, value in data.statements.items() if name in self.law.parameters._fields}
        parameters = self.law.checked({**values, **of_law}, f"{data.label}: {self.law.name}")
        return data.experiment.history(
            Specimen(self.law, parameters, self.law.name, data.label),
            self._settings(data, parameters),
            data.driven(abscissa),
        )

    def _settings(self, data: DataSet, parameters: Any) -> Any:
        fields = data.experiment.settings._fields
        stated = {name: value for name, value in data.statements.items() if name in fields}
        of_law = {name: value for name, value in parameters._asdict().items() if name in fields}
        return checked_parameters(
            f"{data.label}: {data.experiment.name}", data.experiment.settings, {**stated, **of_law}
        )

    def residuals(self, values: Values) -> Array:
        """(law - data)/weight of everything measured, file after file and column after column; raises as `history`."""
        parts = []
        for data in self.data:
            result = self.history(data, values, data.abscissa)
            for measured in data.measured:
                residual = (answer(result, measured) - measured.values) / weight(measured)
                parts.append(residual[np.isfinite(measured.values)])
        return np.concatenate(parts)

    @cached_property
    def knows_errors(self) -> bool:
        """Whether every measured column has standard errors. Raises InputError if only some have them."""
        known = {measured.standard_errors is not None for data in self.data for measured in data.measured}
        if len(known) > 1:
            raise InputError(
                "some measured columns have standard errors and some have none; give them for all or for none"
            )
        return known.pop()


def answer(result: ElementResult, measured: Measured) -> Array:
    """The law's values of a measured quantity at the rows of the data, shape (rows,)."""
    return QUANTITIES[measured.name].of(result)[1:]


def weight(measured: Measured) -> Array:
    """The standard errors or, where they are unknown, the size of the measured values; shape (rows,)."""
    if measured.standard_errors is not None:
        return measured.standard_errors
    size = float(np.sqrt(np.nanmean(measured.values**2)))
    return np.full(measured.values.shape, size or 1.0)
