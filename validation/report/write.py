"""Writing the folder of a validation run."""

import json
from collections.abc import Sequence
from pathlib import Path

from grainlaw.materials import InputError, atomic
from grainlaw.validation.report.content import content
from grainlaw.validation.report.junit import junit
from grainlaw.validation.report.page import page
from grainlaw.validation.result import CaseResult


def prepare(folder: Path) -> None:
    """Make the folder before anything is computed. Raises InputError where it cannot be one."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"--out {folder}: {error.strerror}") from None


def write_report(folder: Path, results: Sequence[CaseResult]) -> list[Path]:
    """Write results.json, junit.xml and report.html; returns their paths."""
    texts = {
        "results.json": json.dumps(content(results), indent=2, allow_nan=False) + "\n",
        "junit.xml": junit(results),
        "report.html": page(results),
    }
    for name, text in texts.items():
        atomic.write_text(folder / name, text)
    return [folder / name for name in texts]
