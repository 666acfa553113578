"""Undrained triaxial compression of normally consolidated Modified Cam Clay against its closed solution."""

import numpy as np

from grainlaw.materials.element.result import ElementResult
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.cases.point.cam_clay_solutions import EXAMPLE
from grainlaw.validation.cases.point.triaxial import example_path, path_convergence, shear_strain

TEST = "triaxial-undrained"
BAND = 1e-4
SHEAR_STRAIN = 0.02


def measurements(assignments: dict[str, float]) -> tuple[Measurement, ...]:
    """P and q at one shear strain, and p at critical state."""
    result = example_path(TEST, 0.03, 2e-6, assignments)
    strains = shear_strain(result)
    p, q = EXAMPLE.undrained_state(SHEAR_STRAIN)
    failed = example_path(TEST, 1.0, 1e-3, assignments)
    failure = EXAMPLE.undrained_pressure(EXAMPLE.critical_state_ratio)
    return (
        relative_error("p at eps_s = 0.02", "Pa", float(np.interp(SHEAR_STRAIN, strains, result.pressure)), p, BAND),
        relative_error(
            "q at eps_s = 0.02", "Pa", float(np.interp(SHEAR_STRAIN, strains, result.deviatoric_stress)), q, BAND
        ),
        relative_error("p at critical state", "Pa", failed.pressure[-1], failure, BAND),
    )


def error_at_the_end(result: ElementResult) -> float:
    """In q."""
    _, q = EXAMPLE.undrained_state(float(shear_strain(result)[-1]))
    return float(abs(result.deviatoric_stress[-1] - q) / q)


def measure(effort: Effort) -> Evidence:
    """The law as it is."""
    coarse = example_path(TEST, 0.1, 2e-3)
    ratios = np.linspace(0.0, EXAMPLE.critical_state_ratio, 60)
    pressures = np.array([EXAMPLE.undrained_pressure(ratio) for ratio in ratios])
    figure = Figure(
        "Undrained stress path, 50 steps",
        "p [kPa]",
        "q [kPa]",
        (
            curve("closed solution", 1e-3 * pressures, 1e-3 * ratios * pressures, "reference"),
            curve("modified_cam_clay", 1e-3 * coarse.pressure, 1e-3 * coarse.deviatoric_stress),
        ),
    )
    return Evidence(measurements({}), (path_convergence("q", TEST, 0.024, effort, error_at_the_end),), (figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A shear modulus of another Poisson's ratio: the stress path stays, the strains along it do not."""
    return measurements({"poisson_ratio": 0.2})


CASE = Case(
    name="mcc_triaxial_undrained",
    title="undrained triaxial compression, Modified Cam Clay",
    proves="plastic and elastic volume changes cancel along the path, and p_c follows: no drift of the volume",
    reference="p/p0 = (M^2/(M^2 + eta^2))^((lambda - kappa)/lambda), eps_s by quadrature (Wood 1990); M 1.2, "
    "lambda 0.10, kappa 0.02, nu 0.3, p0 200 kPa",
    norm="relative error at equal shear strain",
    mistake="shear modulus of nu = 0.2 instead of 0.3",
    measure=measure,
    control=control,
)
