"""The return map of Modified Cam Clay on a million random states and increments."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import njit

from grainlaw.materials.compilation import mark_of_reached, named, pointwise_law, registered
from grainlaw.materials.registry import get_material
from grainlaw.materials.tensor import SymmetricTensor
from grainlaw.plugins.cam_clay import return_map as cam_clay
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.cases.point.random_increments import norm, random_cases, stress_norm

YIELD_BAND, ITERATIONS_BAND, SMALL_INCREMENT_BAND = 1e-10, 6.0, 1e-2
COUNT = {Effort.QUICK: 100_000, Effort.FULL: 1_000_000}
SUBSTEPS, LONGEST_COUNT = 1000, 100
LAW = get_material("modified_cam_clay")
PARAMETERS = LAW.parameter_sets["paper"].parameters
SLOPE = PARAMETERS.critical_state_ratio
CONSTANTS = cam_clay.CamClay(SLOPE, PARAMETERS.compression_index, PARAMETERS.swelling_index, PARAMETERS.poisson_ratio)
LARGEST_STRAIN = 0.2
# How many increments are compared with substeps.
COMPARED = 300


@cache
def compiled() -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The law's step over arrays in n substeps, and the count of the evaluations that its return takes."""
    law = pointwise_law(LAW)
    step, state = registered(cam_clay.cam_clay_step), registered(cam_clay.yield_state)
    first, is_on_surface = registered(cam_clay.first_bracket), registered(cam_clay.is_on_yield_surface)
    trial, updated_bracket = registered(cam_clay.elastic_trial), registered(cam_clay.updated_bracket)
    mark = f"{law.mark}_{mark_of_reached((step, state, first, is_on_surface, trial, updated_bracket))}"

    @njit(cache=True)
    @named(mark)
    def stepped(cases, constants, substeps, results):  # type: ignore[no-untyped-def]
        for k in range(cases.shape[1]):
            p, p_c = cases[0, k], cases[1, k]
            s = SymmetricTensor(cases[2, k], cases[3, k], cases[4, k], cases[5, k], cases[6, k], cases[7, k])
            compression = -(cases[8, k] + cases[9, k] + cases[10, k]) / substeps
            third = compression / 3.0
            shear = SymmetricTensor(
                cases[8, k] / substeps + third,
                cases[9, k] / substeps + third,
                cases[10, k] / substeps + third,
                cases[11, k] / substeps,
                cases[12, k] / substeps,
                cases[13, k] / substeps,
            )
            for _ in range(substeps):
                p, p_c, s, _plastic_shear, _plastic_compression = step(p, s, compression, shear, p_c, constants, 0.0)
            results[0, k], results[1, k] = p, p_c
            results[2, k], results[3, k], results[4, k] = s.xx, s.yy, s.zz
            results[5, k], results[6, k], results[7, k] = s.xy, s.yz, s.xz

    @njit(cache=True)
    @named(mark)
    def evaluations(cases, constants, longest, counts):  # type: ignore[no-untyped-def]
        for k in range(cases.shape[1]):
            s = SymmetricTensor(cases[2, k], cases[3, k], cases[4, k], cases[5, k], cases[6, k], cases[7, k])
            compression = -(cases[8, k] + cases[9, k] + cases[10, k])
            third = compression / 3.0
            shear = SymmetricTensor(
                cases[8, k] + third, cases[9, k] + third, cases[10, k] + third, cases[11, k], cases[12, k], cases[13, k]
            )
            start = trial(cases[0, k], s, compression, shear, cases[1, k], constants)
            bracket = first(start.log_pressure_ratio)
            for count in range(1, longest + 1):
                new = state(bracket.theta, start, constants)
                counts[k] = count
                if is_on_surface(new):
                    break
                bracket = updated_bracket(bracket, new)

    return stepped, evaluations


def stepped(cases: np.ndarray, substeps: int = 1) -> np.ndarray:
    """p, p_c and the six components of s [Pa] after the increments; shape (8, count)."""
    results = np.empty((8, cases.shape[1]))
    compiled()[0](cases, CONSTANTS, substeps, results)
    return results


def yield_error(results: np.ndarray) -> np.ndarray:
    """|F|/p_c^2 of states after a step; shape (count,)."""
    p, p_c = results[:2]
    q_squared = 1.5 * norm(results[2:]) ** 2
    return np.asarray(np.abs(q_squared / SLOPE**2 - p * (p_c - p)) / p_c**2)


def evaluations(cases: np.ndarray) -> np.ndarray:
    """How often the return map of each plastic increment evaluates its residual; shape (count,)."""
    counts = np.empty(cases.shape[1], np.int64)
    compiled()[1](cases, CONSTANTS, LONGEST_COUNT, counts)
    return counts


def substep_errors(largest: float, count: int) -> np.ndarray:
    """|sigma - sigma_1000| / |sigma_1000| of one step against 1000 substeps, from the yield surface, plastic only."""
    cases = random_cases(count, 0.5 * largest, largest, SLOPE, largest_ocr=1.0)
    fine, coarse = stepped(cases, SUBSTEPS), stepped(cases)
    plastic = fine[1] != cases[1]
    return (stress_norm(fine - coarse) / stress_norm(fine))[plastic]


def measure(effort: Effort) -> Evidence:
    """The law as it is."""
    cases = random_cases(COUNT[effort], 1e-8, LARGEST_STRAIN, SLOPE)
    results = stepped(cases)
    plastic = results[1] != cases[1]
    counts = evaluations(cases[:, plastic])
    strains = (1e-5, 1e-4, 1e-3, 1e-2, 1e-1) if effort is Effort.FULL else (1e-5, 1e-3)
    errors = [substep_errors(strain, COMPARED) for strain in strains]
    medians = [float(np.median(found)) for found in errors]
    figure = Figure(
        "One step against 1000 substeps",
        "largest strain of an increment [1]",
        "median relative error of the stress",
        (curve("modified_cam_clay", strains, medians),),
        logarithmic="xy",
    )
    stated = "; ".join(
        f"{strain:g}: {np.median(found):.1e} / {np.quantile(found, 0.95):.1e} / {found.max():.1e}"
        for strain, found in zip(strains, errors, strict=True)
    )
    notes = (
        f"{cases.shape[1]:,} increments, {plastic.mean():.1%} of them plastic; at most {counts.max()} iterations",
        f"one step against {SUBSTEPS} substeps, median / 95 % / largest relative error by strain: {stated}",
    )
    lowest = float(results[0].min())
    found = (
        upper_bound("results that are not a number", "1", float((~np.isfinite(results)).any(axis=0).sum()), 0.5),
        upper_bound("largest |F|/p_c^2", "1", float(yield_error(results[:, plastic]).max()), YIELD_BAND),
        upper_bound("pressure below zero", "Pa", max(0.0, -lowest), 1e-300),
        upper_bound("mean iterations of a return", "1", float(counts.mean()), ITERATIONS_BAND),
        upper_bound("median error of one step of strain 1e-5", "1", medians[0], SMALL_INCREMENT_BAND),
    )
    return Evidence(found, figures=(figure,), notes=notes)


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The right stress with the p_c of before the step."""
    cases = random_cases(10_000, 1e-8, LARGEST_STRAIN, SLOPE)
    results = stepped(cases)
    plastic = results[1] != cases[1]
    trial = results.copy()
    trial[1] = cases[1]
    return (upper_bound("largest |F|/p_c^2", "1", float(yield_error(trial[:, plastic]).max()), YIELD_BAND),)


CASE = Case(
    name="return_mapping",
    title="return map of Modified Cam Clay, a million increments",
    proves="the return map cannot fail: any state, any overconsolidation, any increment up to 20 %",
    reference="F = 0 after every plastic step; 1000 substeps of the same law; p 1 Pa to 1 MPa, OCR 1 to 100, strain up "
    "to 0.2, all spread evenly in the logarithm",
    norm="|F|/p_c^2; evaluations of the residual; relative error of the stress",
    mistake="hardening left out: p_c stays what it was before the step",
    measure=measure,
    control=control,
)
