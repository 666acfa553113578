"""What a data file may measure, and how each quantity follows from an element test.

Compression-positive, and in the axes of the element tests: yy is the axis of a compression test and the normal of the
shear plane of a shear test, xy the shear.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials.element.result import ElementResult

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Quantity:
    """A measured quantity: SI unit, one-line doc, and its values over an element test, shape (points,)."""

    unit: str
    doc: str
    of: Callable[[ElementResult], Array]


def _normal_stress(result: ElementResult) -> Array:
    return np.asarray(-result.stress[:, 1])


def _shear_stress(result: ElementResult) -> Array:
    return np.asarray(result.stress[:, 3])


QUANTITIES = {
    "pressure": Quantity("Pa", "mean pressure p", lambda result: result.pressure),
    "deviatoric_stress": Quantity("Pa", "deviatoric stress q", lambda result: result.deviatoric_stress),
    "stress_ratio": Quantity("1", "q/p", lambda result: result.deviatoric_stress / result.pressure),
    "axial_stress": Quantity("Pa", "compressive stress along the axis of a compression test", _normal_stress),
    "radial_stress": Quantity(
        "Pa", "compressive stress across the axis of a compression test", lambda result: -result.stress[:, 0]
    ),
    "normal_stress": Quantity("Pa", "compressive stress on the plane of shear", _normal_stress),
    "shear_stress": Quantity("Pa", "shear stress on the plane of shear", _shear_stress),
    "friction": Quantity(
        "1",
        "shear stress over the normal stress on the plane of shear",
        lambda result: _shear_stress(result) / _normal_stress(result),
    ),
    "friction_of_mean_pressure": Quantity(
        "1", "shear stress over the mean pressure p", lambda result: _shear_stress(result) / result.pressure
    ),
    "volumetric_strain": Quantity(
        "1", "logarithmic volumetric strain eps_v since the start", lambda result: result.volumetric_strain
    ),
    "specific_volume": Quantity("1", "v = rho_p/rho", lambda result: np.exp(result.log_specific_volume)),
    "solid_fraction": Quantity("1", "phi = rho/rho_p", lambda result: np.exp(-result.log_specific_volume)),
}
