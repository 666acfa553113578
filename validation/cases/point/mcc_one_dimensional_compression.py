"""One-dimensional normal compression of Modified Cam Clay: the coefficient of earth pressure at rest."""

import math

from grainlaw.materials.element.result import ElementResult
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.cases.point.cam_clay_solutions import EXAMPLE
from grainlaw.validation.cases.point.triaxial import example_path, path_convergence

TEST = "oedometer"
BAND = 1e-4
# Far enough to forget the isotropic start.
FINAL_STRAIN = 0.64
TRANSIENT_STRAIN = 0.032


def earth_pressure(result: ElementResult) -> float:
    """sigma_radial/sigma_axial at the end."""
    return float(result.stress[-1, 0] / result.stress[-1, 1])


def measurements(assignments: dict[str, float]) -> tuple[Measurement, ...]:
    """K0, and the slope of compression between the middle and the end."""
    result = example_path(TEST, FINAL_STRAIN, 1e-5, assignments)
    middle = len(result.time) // 2
    log_pressure = math.log(result.pressure[-1] / result.pressure[middle])
    slope = (result.log_specific_volume[middle] - result.log_specific_volume[-1]) / log_pressure
    reference = EXAMPLE.earth_pressure_at_rest()
    return (
        relative_error("K0", "1", earth_pressure(result), reference, BAND),
        relative_error("slope of ln v over ln p", "1", slope, EXAMPLE.compression_index, BAND),
    )


def error_on_the_way(result: ElementResult) -> float:
    """In the axial stress between the isotropic state and K0."""
    p, q = EXAMPLE.one_dimensional_state(TRANSIENT_STRAIN)
    reference = p + 2.0 / 3.0 * q
    return float(abs(-result.stress[-1, 1] - reference) / reference)


def measure(effort: Effort) -> Evidence:
    """The law as it is."""
    result = example_path(TEST, FINAL_STRAIN, 8e-3)
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
    order = path_convergence("axial stress", TEST, TRANSIENT_STRAIN, effort, error_on_the_way)
    return Evidence(measurements({}), (order,), (figure,))


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
