"""What an element test returns: the history of one point, and the table that it is written as."""

import csv
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials.element.point import Point
from grainlaw.materials.element.specimen import Specimen
from grainlaw.materials.tensor import (
    SymmetricTensor,
    deviatoric_stress,
    equivalent_shear_stress,
    pressure,
    shear_strain_rate,
)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Column:
    """One quantity over time: name, SI unit, values of shape (points,)."""

    name: str
    unit: str
    values: Array


@dataclass(frozen=True)
class ElementResult:
    """The history of an element test.

    specimen  the law, the parameter values that were used and where they came from
    test      name of the element test
    settings  the settings of the test, a NamedTuple
    steps     number of steps that were computed
    points    the point at the times that were kept, first and last included
    """

    specimen: Specimen
    test: str
    settings: Any
    steps: int
    points: Sequence[Point]

    @property
    def grain_density(self) -> float:
        """Density rho_p [kg/m3] by which specific volume is counted: the law's own or, without one, the test's."""
        return self.specimen.declared("grain_density", self.settings.grain_density)

    @cached_property
    def time(self) -> Array:
        """Time [s], shape (points,)."""
        return np.array([point.time for point in self.points])

    @cached_property
    def stress(self) -> Array:
        """Stress xx, yy, zz, xy, yz, xz [Pa], shape (points, 6)."""
        return np.array([point.stress for point in self.points])

    @cached_property
    def strain(self) -> Array:
        """Logarithmic strain xx, yy, zz, xy, yz, xz, shape (points, 6)."""
        return np.array([point.strain for point in self.points])

    @cached_property
    def density(self) -> Array:
        """Bulk density [kg/m3], shape (points,)."""
        return np.array([point.density for point in self.points])

    @cached_property
    def pressure(self) -> Array:
        """Mean pressure p [Pa], shape (points,)."""
        return np.array([pressure(point.stress) for point in self.points])

    @cached_property
    def deviatoric_stress(self) -> Array:
        """Deviatoric stress q [Pa], shape (points,)."""
        return np.array([deviatoric_stress(point.stress) for point in self.points])

    @cached_property
    def volumetric_strain(self) -> Array:
        """eps_v since the start, compression-positive, from the specific volumes, shape (points,)."""
        return self.log_specific_volume[0] - self.log_specific_volume

    @cached_property
    def shear_strain_rate(self) -> Array:
        """gamma_dot [1/s] over the step that led to each point, shape (points,); zero in the first point."""
        return np.array([shear_strain_rate(point.strain_rate) for point in self.points])

    @cached_property
    def viscosity(self) -> Array:
        """Apparent viscosity eta = tau/gamma_dot = q/(sqrt(3) gamma_dot) [Pa.s]; NaN where nothing flows."""
        shear_stress = np.array([equivalent_shear_stress(point.stress) for point in self.points])
        rate = self.shear_strain_rate
        return np.divide(shear_stress, rate, out=np.full(rate.shape, np.nan), where=rate > 0.0)

    @cached_property
    def log_specific_volume(self) -> Array:
        """Logarithm of the specific volume, ln v = ln(rho_p/rho), shape (points,)."""
        return np.log(self.grain_density / self.density)

    def state_variable(self, name: str) -> Array:
        """A state variable of the law over time, shape (points,)."""
        return np.array([getattr(point.state, name) for point in self.points])

    @property
    def columns(self) -> list[Column]:
        """All quantities over time, in the order in which they are written."""
        components = SymmetricTensor._fields
        return [
            Column("time", "s", self.time),
            *(Column(f"stress_{name}", "Pa", self.stress[:, i]) for i, name in enumerate(components)),
            *(Column(f"strain_{name}", "1", self.strain[:, i]) for i, name in enumerate(components)),
            Column("density", "kg/m3", self.density),
            Column("log_specific_volume", "1", self.log_specific_volume),
            Column("pressure", "Pa", self.pressure),
            Column("deviatoric_stress", "Pa", self.deviatoric_stress),
            Column("shear_strain_rate", "1/s", self.shear_strain_rate),
            Column("viscosity", "Pa.s", self.viscosity),
            *(
                Column(name, declaration.unit, self.state_variable(name))
                for name, declaration in self.specimen.law.state_declarations.items()
            ),
        ]

    def write_csv(self, path: Path) -> None:
        """Write all columns under a header of `name [unit]`; the file appears whole or not at all."""
        columns = self.columns
        temporary = path.with_name(f".{path.name}.partial")
        with temporary.open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(f"{column.name} [{column.unit}]" for column in columns)
            writer.writerows(zip(*(column.values.tolist() for column in columns), strict=True))
        os.replace(temporary, path)
