"""One-dimensional normal compression of Modified Cam Clay: the coefficient of earth pressure at rest."""

import math

from grainlaw.materials.element.result import ElementResult
from grainlaw.validation.case import Case, Convergence, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.cases.point.cam_clay_solutions import EXAMPLE
from grainlaw.validation.cases.point.element import element_history
from grainlaw.validation.cases.point.triaxial import axial_strains, example_values

BAND = 1e-4
FINAL_STRAIN = 0.64
TRANSIENT_STRAIN = 0.032


def compression(strain_of_a_step: float, assignments: dict[str, float] | None = None) -> ElementResult:
    """Axial compression without lateral strain, far enough to forget the isotropic start."""
    values = example_values(FINAL_STRAIN, strain_of_a_step) | (assignments or {})
    return element_history("oedometer", "modified_cam_clay", None, values)


def earth_pressure(result: ElementResult) -> float:
    """sigma_radial/sigma_axial at the end."""
    return float(result.stress[-1, 0] / result.stress[-1, 1])


def measurements(assignments: dict[str, float]) -> tuple[Measurement, ...]:
    """K0, and the slope of compression between the middle and the end."""
    result = compression(1e-5, assignments)
    middle = len(result.time) // 2
    log_pressure = math.log(result.pressure[-1] / result.pressure[middle])
    slope = (result.log_specific_volume[middle] - result.log_specific_volume[-1]) / log_pressure
    reference = EXAMPLE.earth_pressure_at_rest()
    return (
        relative_error("K0", "1", earth_pressure(result), reference, BAND),
        relative_error("slope of ln v over ln p", "1", slope, EXAMPLE.compression_index, BAND),
    )


def convergence(effort: Effort) -> Convergence:
    """Error in the axial stress on the way from the isotropic state to K0, over the strain of a step."""
    p, q = EXAMPLE.one_dimensional_state(TRANSIENT_STRAIN)
    reference = p + 2.0 / 3.0 * q
    errors = []
    for size in axial_strains(effort):
        values = example_values(TRANSIENT_STRAIN, size)
        result = element_history("oedometer", "modified_cam_clay", None, values)
        errors.append(abs(-result.stress[-1, 1] - reference) / reference)
    return Convergence("axial stress", "axial strain of a step", axial_strains(effort), tuple(errors), least_order=0.95)


def measure(effort: Effort) -> Evidence:
    """The law as it is."""
    result = compression(8e-3)
    ratio = result.stress[:, 0] / result.stress[:, 1]
    reference = EXAMPLE.earth_pressure_at_rest()
    figure = Figure(
        "One-dimensional compression, 80 steps",
        "axial strain [1]",
        "sigma_radial/sigma_axial [1]",
        (
            curve("K0", [0.0, FINAL_STRAIN], [reference, reference], "reference"),
            curve("modified_cam_clay", -result.strain[:, 1], ratio),
        ),
    )
    return Evidence(measurements({}), (convergence(effort),), (figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Another slope of the critical state line."""
    return measurements({"critical_state_ratio": 1.25})


CASE = Case(
    name="mcc_one_dimensional_compression",
    title="one-dimensional compression, Modified Cam Clay",
    proves="the direction of plastic flow: K0 depends on it and on nothing that a triaxial path tests",
    reference="eta of d(eps_s) = 2/3 d(eps_v) with eta constant: (lambda - kappa) 2 eta/(M^2 - eta^2) + kappa "
    "eta/(3 G/K) = 2/3 lambda; K0 = (3 - eta)/(3 + 2 eta) = 0.64763; M 1.2, lambda 0.10, kappa 0.02, nu 0.3; "
    "on the way there the rate equations, integrated to 1e-12",
    norm="relative error",
    mistake="M = 1.25 instead of 1.2",
    measure=measure,
    control=control,
)
