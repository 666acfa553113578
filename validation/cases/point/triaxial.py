"""Strains and settings of triaxial paths on the worked example of Modified Cam Clay."""

from typing import Any

from grainlaw.materials.element.result import ElementResult
from grainlaw.validation.case import Effort
from grainlaw.validation.cases.point.cam_clay_solutions import EXAMPLE

STRAIN_RATE = 0.01


def example_values(final_strain: float, strain_of_a_step: float) -> dict[str, float]:
    """Constants of the worked example, and settings of a path; strains of the driven component."""
    return {
        "critical_state_ratio": EXAMPLE.critical_state_ratio,
        "compression_index": EXAMPLE.compression_index,
        "swelling_index": EXAMPLE.swelling_index,
        "poisson_ratio": EXAMPLE.poisson_ratio,
        "initial_pressure": EXAMPLE.initial_pressure,
        "overconsolidation_ratio": 1.0,
        "strain_rate": STRAIN_RATE,
        "final_strain": final_strain,
        "time_step": strain_of_a_step / STRAIN_RATE,
    }


def axial_strains(effort: Effort) -> tuple[float, ...]:
    """Axial strains of a step over which an order is observed."""
    return (2e-3, 1e-3, 5e-4) if effort is Effort.QUICK else (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4)


def shear_strain(result: ElementResult) -> Any:
    """eps_s = 2/3 (eps_axial - eps_radial), compression-positive, shape (points,)."""
    return 2.0 / 3.0 * (result.strain[:, 0] - result.strain[:, 1])
