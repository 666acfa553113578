"""Drained triaxial compression of normally consolidated Modified Cam Clay against its closed solution."""

import numpy as np

from grainlaw.materials.element.result import ElementResult
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, relative_error
from grainlaw.validation.cases.point.cam_clay_solutions import EXAMPLE
from grainlaw.validation.cases.point.triaxial import example_path, path_convergence, shear_strain

TEST = "triaxial-drained"
BAND = 1e-4
SHEAR_STRAIN = 0.1


def state_at(result: ElementResult, strain: float) -> tuple[float, float]:
    """Q [Pa] and eps_v at a shear strain between two kept states."""
    strains = shear_strain(result)
    q = float(np.interp(strain, strains, result.deviatoric_stress))
    return q, float(np.interp(strain, strains, result.volumetric_strain))


def measurements(assignments: dict[str, float]) -> tuple[Measurement, ...]:
    """Stress and volume at one shear strain, and the stress at critical state."""
    result = example_path(TEST, 0.15, 1e-5, assignments)
    measured_q, measured_volume = state_at(result, SHEAR_STRAIN)
    q, volume = EXAMPLE.drained_state(SHEAR_STRAIN)
    failed = example_path(TEST, 2.0, 1e-3, assignments)
    return (
        relative_error("q at eps_s = 0.1", "Pa", measured_q, q, BAND),
        relative_error("eps_v at eps_s = 0.1", "1", measured_volume, volume, BAND),
        relative_error("q at critical state", "Pa", failed.deviatoric_stress[-1], EXAMPLE.drained_failure(), BAND),
    )


def error_at_the_end(result: ElementResult) -> float:
    """In q."""
    q, _ = EXAMPLE.drained_state(float(shear_strain(result)[-1]))
    return float(abs(result.deviatoric_stress[-1] - q) / q)


def measure(effort: Effort) -> Evidence:
    """The law as it is."""
    coarse = example_path(TEST, 0.15, 5e-3)
    strains = shear_strain(coarse)[1:]
    exact = [EXAMPLE.drained_state(float(strain)) for strain in strains]
    figure = Figure(
        "Drained triaxial compression, 30 steps",
        "shear strain [1]",
        "q [kPa]",
        (
            curve("closed solution", strains, [1e-3 * q for q, _ in exact], "reference"),
            curve("modified_cam_clay", strains, 1e-3 * coarse.deviatoric_stress[1:]),
        ),
    )
    return Evidence(measurements({}), (path_convergence("q", TEST, 0.064, effort, error_at_the_end),), (figure,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Slopes that belong to v over ln p at v = 1.6, used as if they belonged to ln v."""
    return measurements({"compression_index": 0.16, "swelling_index": 0.032})


CASE = Case(
    name="mcc_triaxial_drained",
    title="drained triaxial compression, Modified Cam Clay",
    proves="flow rule (its factor 1/3), hardening and elasticity of Modified Cam Clay, integrated without drift",
    reference="dq = 3 dp: p = 3 p0/(3 - eta), eps_v = lambda ln(p/p0) + (lambda - kappa) ln(1 + eta^2/M^2), eps_s by "
    "quadrature (Wood 1990); M 1.2, lambda 0.10, kappa 0.02, nu 0.3, p0 200 kPa",
    norm="relative error at equal shear strain",
    mistake="slopes in v over ln p (times v = 1.6) taken for slopes in ln v",
    measure=measure,
    control=control,
)
