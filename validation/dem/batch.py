"""Many runs one after the other, resumable: what is finished is left alone, what fails is told at the end."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from grainlaw.materials.errors import InputError, SimulationError, nearest_name
from grainlaw.validation.dem.catalogue import CASES
from grainlaw.validation.dem.description import AnyCase
from grainlaw.validation.dem.runs import Run, finished, perform


@dataclass(frozen=True)
class Outcome:
    """What became of a run: "made", "kept" (it was finished) or the reason why it failed."""

    run: Run
    text: str

    @property
    def failed(self) -> bool:
        """Whether the run is still missing."""
        return self.text not in ("made", "kept")


def case_named(name: str) -> AnyCase:
    """The case of the catalogue with this name. Raises InputError for a name that is not there."""
    cases = {case.name: case for case in CASES}
    if name not in cases:
        raise InputError(f"no DEM case '{name}'; {nearest_name(name, cases)}")
    return cases[name]


def perform_all(runs: Sequence[Run], out: Path, time_limit: float, report: Callable[[Run, str], None]) -> list[Outcome]:
    """Make every run that is not finished below `out`, at most `time_limit` [s] for each deck.

    A failing run does not stop the others; a missing code raises InputError when its turn comes.
    """
    outcomes = []
    for run in runs:
        if finished(run, out):
            outcomes.append(Outcome(run, "kept"))
        else:
            outcomes.append(Outcome(run, _try(run, out, time_limit, report)))
        report(run, outcomes[-1].text)
    return outcomes


def _try(run: Run, out: Path, time_limit: float, report: Callable[[Run, str], None]) -> str:
    try:
        perform(run, out, time_limit, lambda line: report(run, line))
    except SimulationError as error:
        return str(error)
    return "made"
