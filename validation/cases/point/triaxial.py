"""Strains and settings of triaxial paths on the worked example of Modified Cam Clay."""

from collections.abc import Callable, Mapping
from typing import Any

from grainlaw.materials.element.result import ElementResult
from grainlaw.validation.case import Convergence, Effort
from grainlaw.validation.cases.point.cam_clay_solutions import EXAMPLE
from grainlaw.validation.cases.point.element import element_history

STRAIN_RATE = 0.01


def example_path(
    test: str, final_strain: float, strain_of_a_step: float, assignments: Mapping[str, float] | None = None
) -> ElementResult:
    """The worked example along the path of an element test; strains of the driven component."""
    values = {
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
    return element_history(test, "modified_cam_clay", None, values | dict(assignments or {}))


def path_convergence(
    name: str, test: str, final_strain: float, effort: Effort, error: Callable[[ElementResult], float]
) -> Convergence:
    """An error at the end of a path over the axial strain of a step."""
    sizes = (2e-3, 1e-3, 5e-4) if effort is Effort.QUICK else (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4)
    errors = tuple(error(example_path(test, final_strain, size)) for size in sizes)
    return Convergence(name, "axial strain of a step", sizes, errors, least_order=0.95)


def shear_strain(result: ElementResult) -> Any:
    """eps_s = 2/3 (eps_axial - eps_radial), compression-positive, shape (points,)."""
    return 2.0 / 3.0 * (result.strain[:, 0] - result.strain[:, 1])
