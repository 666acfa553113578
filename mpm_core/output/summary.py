"""`summary.json`: what a finished run was, what it led to and what it cost."""

from pathlib import Path

from pydantic import BaseModel, ConfigDict, FiniteFloat, NonNegativeInt, ValidationError

from grainlaw.materials import InputError, atomic
from grainlaw.materials.faults import fault_in_words

SUMMARY_NAME = "summary.json"


class FinalState(BaseModel):
    """Runout [m], height [m], height of the centre of mass [m] and kinetic energy at the end of the run.

    As in the history, energies are per width [J/m], per radian [J/rad] or of the whole [J], as the space has it.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    runout: FiniteFloat
    height: FiniteFloat
    center_of_mass_height: FiniteFloat | None
    kinetic_energy: FiniteFloat


def in_digits(length: float | None) -> str:
    """A length [m] as tables show it; a dash for one that there is not."""
    return "-" if length is None else f"{length:.4f}"


class RunSummary(BaseModel):
    """One run: times in seconds, memory in bytes, `energy_balance_error` relative to the energy that was released.

    `limited` counts what is bounded at the end instead of clipped (`output.bounded_points`). `material` names the law,
    or the laws of a scene with several, joined by commas.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    scene: str
    material: str
    points: NonNegativeInt
    cells: NonNegativeInt
    steps: NonNegativeInt
    simulated_time: FiniteFloat
    mass_left: FiniteFloat = 0.0
    points_left: NonNegativeInt = 0
    mass_in: FiniteFloat = 0.0
    points_in: NonNegativeInt = 0
    wall_time: FiniteFloat
    compile_time: FiniteFloat
    point_steps_per_second: FiniteFloat
    peak_memory_bytes: NonNegativeInt
    final: FinalState
    energy_balance_error: FiniteFloat
    limited: dict[str, NonNegativeInt]
    threads: NonNegativeInt
    version: str


def write_summary(folder: Path, summary: RunSummary) -> None:
    """Write the summary into a run's folder."""
    atomic.write_text(folder / SUMMARY_NAME, summary.model_dump_json(indent=2) + "\n")


def read_summary(folder: Path) -> RunSummary:
    """The summary of a run's folder.

    Raises InputError if the run has not finished (no summary yet) or the file cannot be read.
    """
    path = folder / SUMMARY_NAME
    if not path.is_file():
        raise InputError(f"{folder} holds no {SUMMARY_NAME}: the run has not finished")
    try:
        return RunSummary.model_validate_json(path.read_bytes())
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{path} cannot be read: {fault_in_words(first, key)}") from error
