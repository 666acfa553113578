"""Which runs of the catalogue a reference set holds, and which are still missing."""

import json
from pathlib import Path

from grainlaw.validation.dem.description import AnyCase
from grainlaw.validation.dem.reduction import COLLAPSES, PROVENANCE
from grainlaw.validation.dem.runs import Run, runs_of


def present_runs(reference: Path) -> set[str]:
    """Names of the runs behind a reference set, as `Run.name` gives them."""
    found = set()
    for path in (reference / COLLAPSES).glob("*.h5"):
        case, code, seed = path.stem.rsplit("_", 2)
        found.add(f"{case}/{code}-seed{seed.removeprefix('s')}")
    provenance = reference / PROVENANCE
    if provenance.is_file():
        found |= set(json.loads(provenance.read_text(encoding="utf-8")))
    return found


def missing_runs(case: AnyCase, reference: Path) -> list[Run]:
    """The runs of a case that a reference set lacks."""
    present = present_runs(reference)
    return [run for run in runs_of(case) if run.name not in present]


def seeds_told(runs: list[Run]) -> str:
    """Codes with their seeds, in words."""
    codes = dict.fromkeys(run.code for run in runs)
    return "; ".join(f"{code} {' '.join(str(run.seed) for run in runs if run.code == code)}" for code in codes)
