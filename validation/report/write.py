"""Writing the files of a report."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from grainlaw.materials import InputError, atomic


def prepare(folder: Path) -> None:
    """Make the folder before anything is computed. Raises InputError where it cannot be one."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"--out {folder}: {error.strerror}") from None


def write_texts(folder: Path, texts: Mapping[str, str]) -> list[Path]:
    """Write files by name into a folder; returns their paths."""
    for name, text in texts.items():
        atomic.write_text(folder / name, text)
    return [folder / name for name in texts]


def as_json(content: Any) -> str:
    """Plain values as JSON, which has no number that is not finite: such a one becomes null."""
    return json.dumps(_finite(content), indent=2, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float):
        # float() because numpy's own floats are no JSON numbers in every encoder.
        return float(value) if math.isfinite(value) else None
    return value
