"""The reference lines of critical-state soil mechanics, for laws that declare the quantities behind them.

In ln v over ln p, with the slopes lambda of isotropic compression and kappa of swelling:

    isotropic compression line (ICL)   through p_c:           ln v = ln v0 - kappa ln(p_c/p0) - lambda ln(p/p_c)
    critical state line (CSL)          F's apex, p = p_c/2:   ln v = ICL - (lambda - kappa) ln 2
    overconsolidation line (OCL)       through the state:     ln v = ln v0 - kappa ln(p/p0)

Which lines a law has follows from the names that it declares, so that another critical-state law draws its own.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grainlaw.materials.element.result import ElementResult

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CompressionLines:
    """The three lines through one state: p0 [Pa], ln v0, p_c [Pa], slopes lambda and kappa."""

    pressure: float
    log_specific_volume: float
    preconsolidation_pressure: float
    compression_index: float
    swelling_index: float

    def isotropic_compression(self, pressure: Array) -> Array:
        """Logarithm of the specific volume on the isotropic compression line at p [Pa]."""
        at_preconsolidation = self.overconsolidation(np.asarray(self.preconsolidation_pressure))
        return at_preconsolidation - self.compression_index * np.log(pressure / self.preconsolidation_pressure)

    def critical_state(self, pressure: Array) -> Array:
        """Logarithm of the specific volume on the critical state line at p [Pa]."""
        distance = (self.compression_index - self.swelling_index) * math.log(2.0)
        return self.isotropic_compression(pressure) - distance

    def overconsolidation(self, pressure: Array) -> Array:
        """Logarithm of the specific volume on the swelling line through the state at p [Pa]."""
        return self.log_specific_volume - self.swelling_index * np.log(pressure / self.pressure)


def compression_lines(result: ElementResult) -> CompressionLines | None:
    """The lines through the initial state of a test, or None if the law has none."""
    parameters, state = result.specimen.parameters, result.points[0].state
    if not {"compression_index", "swelling_index"} <= set(parameters._fields):
        return None
    if "preconsolidation_pressure" not in state._fields:
        return None
    return CompressionLines(
        float(result.pressure[0]),
        float(result.log_specific_volume[0]),
        state.preconsolidation_pressure,
        parameters.compression_index,
        parameters.swelling_index,
    )


def critical_stress_ratio(result: ElementResult) -> float | None:
    """q/p at critical state: M, or sqrt(3) mu_0 of slow flow; None if the law declares neither."""
    parameters = result.specimen.parameters
    if "critical_state_ratio" in parameters._fields:
        return float(parameters.critical_state_ratio)
    if "static_friction" in parameters._fields:
        return math.sqrt(3.0) * float(parameters.static_friction)
    return None
