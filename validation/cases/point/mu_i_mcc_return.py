"""The implicit step of mu(I)-MCC on a million random states, increments and inertial numbers."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numba import njit

from grainlaw.materials.compilation import named, pointwise_law
from grainlaw.materials.registry import get_material
from grainlaw.materials.rheology import shear_modulus
from grainlaw.materials.tensor import SymmetricTensor
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.cases.point.random_increments import norm, random_cases

BAND = 1e-8
# Below this strain no increment is taken in parts, and I is that of the whole increment.
WHOLE_STRAIN = 0.003
COUNT = {Effort.QUICK: 100_000, Effort.FULL: 1_000_000}
LAW = get_material("mu_i_mcc")
PARAMETERS = LAW.parameter_sets["paper"].parameters
SLOW, PLASTIC_INDEX = PARAMETERS.critical_state_ratio, PARAMETERS.compression_index - PARAMETERS.swelling_index
SMALLEST_STRAIN, LARGEST_STRAIN, LARGEST_OCR = 1e-8, 0.2, 1000.0
SMALLEST_NUMBER, LARGEST_NUMBER = 1e-6, 10.0


@dataclass(frozen=True)
class Increments:
    """Columns of `random_cases`, and the duration [s] and last inertial number of each; shape (14, count), (count,)."""

    cases: np.ndarray
    durations: np.ndarray
    guesses: np.ndarray


def random_increments(count: int) -> Increments:
    """Increments whose whole shear, at their first pressure, has an inertial number from 1e-6 to 10."""
    cases = random_cases(count, SMALLEST_STRAIN, LARGEST_STRAIN, SLOW, LARGEST_OCR)
    random = np.random.default_rng(7)
    numbers = np.exp(random.uniform(np.log(SMALLEST_NUMBER), np.log(LARGEST_NUMBER), count))
    per_rate = PARAMETERS.grain_diameter / np.sqrt(cases[0] / PARAMETERS.grain_density)
    durations = norm(cases[8:]) / np.sqrt(2.0) * per_rate / numbers
    guesses = np.where(random.uniform(size=count) < 0.5, 0.0, numbers * 10.0 ** random.uniform(-3.0, 3.0, count))
    return Increments(cases, durations, guesses)


@cache
def compiled_step() -> Any:
    """One update of the law over arrays; rows p, s and the three state variables."""
    law = pointwise_law(LAW)
    update, state_class = law.update, law.state

    @njit(cache=True)
    @named(law.mark)
    def step(cases, durations, guesses, parameters, results):  # type: ignore[no-untyped-def]
        for k in range(cases.shape[1]):
            c, dt = cases[:, k], durations[k]
            stress = SymmetricTensor(c[2] - c[0], c[3] - c[0], c[4] - c[0], c[5], c[6], c[7])
            rate = SymmetricTensor(c[8] / dt, c[9] / dt, c[10] / dt, c[11] / dt, c[12] / dt, c[13] / dt)
            new, state = update(stress, rate, 1500.0, state_class(c[1], 0.0, guesses[k]), parameters, dt)
            p = -(new.xx + new.yy + new.zz) / 3.0
            results[0, k] = p
            results[1, k], results[2, k], results[3, k] = new.xx + p, new.yy + p, new.zz + p
            results[4, k], results[5, k], results[6, k] = new.xy, new.yz, new.xz
            results[7, k], results[8, k], results[9, k] = state

    return step


def stepped(increments: Increments) -> np.ndarray:
    """The pressure p and s [Pa], then p_c0, opening strain and I after the increments; shape (10, count)."""
    results = np.empty((10, increments.cases.shape[1]))
    compiled_step()(increments.cases, increments.durations, increments.guesses, PARAMETERS, results)
    return results


@dataclass(frozen=True)
class Consistency:
    """What the equations say of results in contact; arrays of shape (contacts,).

    overstress       F/p_c^2, (1), (2) and (7) at the inertial number that the law gives back
    hardening_error  of p_c0, (7) with the volumetric strain that is not elastic
    number_error     of the inertial number, (6) with the shear strain that is not elastic
    """

    strain: np.ndarray
    number: np.ndarray
    overstress: np.ndarray
    hardening_error: np.ndarray
    number_error: np.ndarray


def consistency(increments: Increments, results: np.ndarray) -> Consistency:
    """The law's equations with the plastic strain that the total strain less the elastic one leaves."""
    contact = (results[8] == 0.0) & (results[0] > 2.0 * PARAMETERS.stress_free_pressure)
    cases, found = increments.cases[:, contact], results[:, contact]
    p, number = found[0], found[9]
    strain = cases[8:].copy()
    compression = -strain[:3].sum(axis=0)
    strain[:3] += compression / 3.0
    growth = np.log(p / cases[0])
    mean_pressure = cases[0] * np.where(growth == 0.0, 1.0, np.expm1(growth) / np.where(growth == 0.0, 1.0, growth))
    modulus = shear_modulus(1.0, PARAMETERS.poisson_ratio) * mean_pressure / PARAMETERS.swelling_index
    plastic_shear = norm(strain - (found[1:7] - cases[2:8]) / (2.0 * modulus)) / np.sqrt(2.0)
    per_rate = PARAMETERS.grain_diameter / np.sqrt(p / PARAMETERS.grain_density)
    number_error = np.abs(plastic_shear / increments.durations[contact] * per_rate - number)

    hardened = cases[1] * np.exp((compression - PARAMETERS.swelling_index * growth) / PLASTIC_INDEX)
    saturation = number / (PARAMETERS.friction_inertial_number + number)
    slope = SLOW + (PARAMETERS.dynamic_state_ratio - SLOW) * saturation
    p_c = found[7] * np.exp(number / (PARAMETERS.dilation_inertial_number * PLASTIC_INDEX))
    overstress = (1.5 * norm(found[1:7]) ** 2 / slope**2 - p * (p_c - p)) / p_c**2
    return Consistency(norm(cases[8:]), number, overstress, np.abs(hardened / found[7] - 1.0), number_error)


def measurements(increments: Increments, results: np.ndarray) -> tuple[Measurement, ...]:
    """Failures, and the largest errors of yield condition, hardening and inertial number."""
    found = consistency(increments, results)
    plastic = found.number > 0.0
    whole = plastic & (found.strain < WHOLE_STRAIN)
    return (
        upper_bound("results that are not a number", "1", float((~np.isfinite(results)).any(axis=0).sum()), 0.5),
        upper_bound("largest |F|/p_c^2 of plastic steps", "1", float(np.abs(found.overstress[plastic]).max()), BAND),
        upper_bound("largest F/p_c^2 of elastic steps", "1", max(0.0, float(found.overstress[~plastic].max())), BAND),
        upper_bound("largest error of p_c0", "1", float(found.hardening_error.max()), BAND),
        upper_bound(
            f"largest error of I, strains below {WHOLE_STRAIN:g}",
            "1",
            float((found.number_error / np.maximum(found.number, 1e-300))[whole].max()),
            BAND,
        ),
        upper_bound("pressure below zero", "Pa", max(0.0, -float(results[0].min())), 1e-300),
    )


def measure(effort: Effort) -> Evidence:
    """The law as it is."""
    increments = random_increments(COUNT[effort])
    results = stepped(increments)
    found = consistency(increments, results)
    plastic = found.number > 0.0
    numbers = found.number[plastic]
    in_parts = plastic & (found.number_error > 1e-6 * found.number)
    edges = np.logspace(-6.0, 1.0, 29)
    counts, _ = np.histogram(numbers, edges)
    figure = Figure(
        "Plastic increments by inertial number",
        "inertial number of the plastic strain [1]",
        "increments [1]",
        (curve("mu_i_mcc", np.sqrt(edges[1:] * edges[:-1]), np.maximum(counts, 0.5)),),
        logarithmic="xy",
    )
    note = (
        f"{results.shape[1]:,} increments, {float((results[9] > 0.0).mean()):.1%} plastic, "
        f"{float((results[8] > 0.0).mean()):.1%} opened, {float(in_parts.mean()):.2%} taken in parts, of a "
        f"strain from {float(found.strain[in_parts].min(initial=LARGEST_STRAIN)):.2g}; plastic inertial number up to "
        f"{numbers.max():.2g}"
    )
    return Evidence(measurements(increments, results), figures=(figure,), notes=(note,))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """The state variable taken for the present size of the surface: its growth with I counted twice."""
    increments = random_increments(10_000)
    results = stepped(increments)
    results[7] *= np.exp(results[9] / (PARAMETERS.dilation_inertial_number * PLASTIC_INDEX))
    return measurements(increments, results)


CASE = Case(
    name="mu_i_mcc_return",
    title="implicit step of mu(I)-MCC, a million increments",
    proves="the step cannot fail: any state, any overconsolidation, any increment up to 20 %, I up to 10",
    reference="equations (1)-(7) of the law with the plastic strain left by total and elastic strain; p 1 Pa to 1 MPa, "
    "OCR 1 to 1000, strain 1e-8 to 0.2, I 1e-6 to 10, all spread evenly in the logarithm",
    norm="|F|/p_c^2; relative errors of p_c0 and I",
    mistake="p_c0 replaced by p_c(I), the growth with the inertial number counted twice",
    measure=measure,
    control=control,
)
