"""Outcomes in a folder, one file each, so that a sweep that was stopped goes on where it was."""

import json
from collections.abc import Callable, Iterable
from pathlib import Path

from grainlaw.materials import SimulationError, atomic
from grainlaw.mpm_core.kernels.sources import CORE_MARK
from grainlaw.validation.cases.speed.setting import Outcome, Setting, as_dict, measured_outcome


def outcomes(
    folder: Path, settings: Iterable[Setting], announce: Callable[[str], None] = lambda line: None
) -> dict[Setting, Outcome | None]:
    """The outcome of each setting, from its file or from a run; None for one that breaks down."""
    folder.mkdir(parents=True, exist_ok=True)
    return {setting: _outcome(folder / f"{setting.key}.json", setting, announce) for setting in settings}


def made_with_other_kernels(found: Iterable[Outcome | None]) -> int:
    """How many outcomes come from files that older or newer sources left."""
    return sum(outcome is not None and outcome.mark != CORE_MARK for outcome in found)


def _outcome(path: Path, setting: Setting, announce: Callable[[str], None]) -> Outcome | None:
    if path.is_file():
        content = json.loads(path.read_text(encoding="utf-8"))
        return None if "failure" in content else Outcome(**content["outcome"])
    try:
        outcome = measured_outcome(setting)
    except SimulationError as error:
        atomic.write_text(path, json.dumps({"failure": str(error)}, indent=2) + "\n")
        announce(f"{setting.key}: {error}")
        return None
    atomic.write_text(path, json.dumps(as_dict(setting, outcome), indent=2) + "\n")
    announce(f"{setting.key}: {outcome.cpu_time:.1f} s")
    return outcome
