"""The results of a validation run as plain values, for JSON."""

from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version
from typing import Any

from grainlaw.validation.case import Measurement
from grainlaw.validation.result import CaseResult


def content(results: Sequence[CaseResult]) -> dict[str, Any]:
    """Everything but the figures."""
    return {
        "version": version("grainlaw"),
        "effort": str(results[0].effort) if results else "",
        "passed": all(result.passed for result in results),
        "wall_time": sum(result.wall_time for result in results),
        "cases": [_case_content(result) for result in results],
    }


def _case_content(result: CaseResult) -> dict[str, Any]:
    case, evidence = result.case, result.evidence
    return {
        "name": case.name,
        "title": case.title,
        "proves": case.proves,
        "reference": case.reference,
        "norm": case.norm,
        "passed": result.passed,
        "reasons": list(result.reasons),
        "wall_time": result.wall_time,
        "measurements": [_measurement_content(found) for found in evidence.measurements],
        "convergence": [
            {
                **asdict(found),
                "orders": list(found.orders),
                "fitted_order": found.fitted_order,
                "reaches_order": found.reaches_order,
            }
            for found in evidence.convergence
        ],
        "control": {
            "mistake": case.mistake,
            "leaves_band": result.control_fails,
            "measurements": [_measurement_content(found) for found in result.control],
        },
        "notes": list(evidence.notes),
    }


def _measurement_content(found: Measurement) -> dict[str, Any]:
    return {**asdict(found), "within_band": found.within_band}
