"""The unified law without inertia is Modified Cam Clay, on every element test."""

import numpy as np

from grainlaw.materials.element.catalogue import ELEMENT_TESTS
from grainlaw.materials.element.result import ElementResult
from grainlaw.validation.case import Case, Effort, Evidence, Measurement, upper_bound
from grainlaw.validation.cases.point.element import element_history

BAND = 1e-8
WITHOUT_INERTIA = {"friction_inertial_number": 1e15, "dilation_inertial_number": 1e15}
SETS = ("paper", "paper_ocr4")
# The paper's test in a tenth of its steps; the others as they come, in steps of strain 1e-4.
SETTINGS = {"constant-pressure-shear": {"time_step": 1e-4}}
STRAINED = {"time_step": 1e-2}


def history(test: str, law: str, parameters: str, changes: dict[str, float]) -> ElementResult:
    """The history of an element test of one of the two laws."""
    return element_history(test, law, parameters, {**SETTINGS.get(test, STRAINED), **changes})


def difference(test: str, parameters: str, changes: dict[str, float]) -> Measurement:
    """The largest difference of a stress component over a path, over the largest stress, and of ln v."""
    clay = history(test, "modified_cam_clay", parameters, {})
    unified = history(test, "mu_i_mcc", parameters, changes)
    stress = np.abs(unified.stress - clay.stress).max() / np.abs(clay.stress).max()
    volume = np.abs(unified.log_specific_volume - clay.log_specific_volume).max()
    return upper_bound(f"{test}, {parameters}: largest difference", "1", float(max(stress, volume)), BAND)


def differences(changes: dict[str, float]) -> tuple[Measurement, ...]:
    """All element tests, at OCR 1 and 4."""
    return tuple(difference(test, parameters, changes) for test in ELEMENT_TESTS for parameters in SETS)


def measure(effort: Effort) -> Evidence:
    """I_M and I_v far beyond any inertial number."""
    return Evidence(differences(WITHOUT_INERTIA))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """I_M and I_v as they are."""
    return (difference("constant-pressure-shear", "paper", {}),)


CASE = Case(
    name="mu_i_mcc_cam_clay_limit",
    title="mu(I)-MCC without inertia is Modified Cam Clay",
    proves="the unified law contains its solid-like parent, paths and not only end states",
    reference="`modified_cam_clay` on every element test at OCR 1 and 4; I_M = I_v = 1e15",
    norm="largest difference of a stress component over the path, over the largest stress; of ln v",
    mistake="I_M and I_v finite",
    measure=measure,
    control=control,
)
