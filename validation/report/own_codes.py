"""A user's runs beside the states of other MPM codes."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from grainlaw.materials.errors import InputWarning
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.space import Space
from grainlaw.validation.grains.observation import Observation
from grainlaw.validation.grains.run_observation import diameter_of_run, mean_density, observe_run, start_of_run
from grainlaw.validation.mpm.piles import PileDistance, compare_piles
from grainlaw.validation.mpm.state import Start, State, read_state, spacing_of
from grainlaw.validation.report.code_figures import pile_figure
from grainlaw.validation.report.code_tables import pile_table
from grainlaw.validation.report.page import Picture, Section

TITLE = "Runs beside other MPM codes"


def runs_beside_codes(folders: Sequence[Path], files: Sequence[Path]) -> list[PileDistance]:
    """Each run beside each state, all spread with one kernel.

    Its width is the grain diameter of the law, or the distance of the points at the start where that is larger.
    Raises InputError in one line for whatever cannot be read, and for columns of different size.
    """
    pairs = [_Pair.of(folder, state) for folder in folders for state in map(read_state, files)]
    width = max(pair.least_width for pair in pairs)
    return [pair.compared(width) for pair in pairs]


@dataclass(frozen=True)
class _Pair:
    """A run and a state, the space in which they are compared, and volume [m3] and spacing [m] of the run's points."""

    folder: Path
    state: State
    space: Space
    volume: float
    spacing: float

    @classmethod
    def of(cls, folder: Path, state: State) -> "_Pair":
        space = state.description.in_space(RunFolder(folder).space)
        return cls(folder, state, space, *start_of_run(folder, space))

    @property
    def least_width(self) -> float:
        """Of the kernel [m]."""
        theirs = spacing_of(self.state, self.volume, self.space)
        return max(diameter_of_run(self.folder) or 0.0, self.spacing, theirs)

    def compared(self, width: float) -> PileDistance:
        """Both spread with a kernel of this width [m]."""
        run = observe_run(self.folder, width, mean_density(self.folder), self.space)
        code = self.state.observed(Start(self.volume, width), self.space, float(run.times[-1]))
        _warn_of_other_times(run, code)
        return compare_piles(run, code, width)


def _warn_of_other_times(run: Observation, code: Observation) -> None:
    """Warn, as InputWarning, where a state is of another time than the last of the run."""
    end, first = float(run.times[-1]), float(code.times[0])
    if first > end:
        warnings.warn(
            f"{code.label} is at t = {first:g} s, {run.label} ends at {end:g} s and is compared as it is then",
            InputWarning,
            stacklevel=2,
        )


def codes_section(found: Sequence[PileDistance]) -> Section:
    """The table and the figure of a page."""
    table = pile_table(found, TITLE)
    caption = "Piles of other codes, black, over ours, at the times of the table."
    return Section(TITLE, tables=(table,), figures=(Picture(pile_figure(found), caption),))
