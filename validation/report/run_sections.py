"""Finished runs as sections of a page: their final states, history and pictures."""

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from grainlaw.mpm_core.output.history import energy_unit
from grainlaw.mpm_core.output.pictures import draw_history, write_run_pictures
from grainlaw.mpm_core.output.run_folder import SCENE_NAME, RunFolder
from grainlaw.mpm_core.output.summary import in_digits
from grainlaw.validation.report.page import Picture, Section, Table
from grainlaw.validation.report.plots import embedded

COLUMNS = (
    "run",
    "law",
    "points",
    "t [s]",
    "runout [m]",
    "height [m]",
    "centre of mass [m]",
    "kinetic energy",
    "energy balance",
    "wall [s]",
    "million point-steps/s",
)


def run_sections(folders: Sequence[Path]) -> list[Section]:
    """One section for all runs together and one for each. Raises InputError for a run that has not finished."""
    runs = [(folder.name, RunFolder(folder)) for folder in folders]
    table = Table("Runs", "Final states; cost with output.", COLUMNS, tuple(_row(name, run) for name, run in runs))
    history = _drawn(lambda path: draw_history(runs, path))
    figures = (Picture(history, "Runout, heights and energies over time."),)
    names = " ".join(str(folder) for folder in folders)
    parts = [Section(table.title, (), (table,), figures, f"grainlaw compare {names} --out DIR")]
    return [*parts, *(_run_section(folder) for folder in folders)]


def _row(name: str, run: RunFolder) -> tuple[str, ...]:
    summary, final = run.summary, run.summary.final
    return (
        name,
        summary.material,
        f"{summary.points}",
        f"{summary.simulated_time:.3g}",
        f"{final.runout:.4f}",
        f"{final.height:.4f}",
        in_digits(final.center_of_mass_height),
        f"{final.kinetic_energy:.3g} {energy_unit(run.space)}",
        f"{summary.energy_balance_error:.1e}",
        f"{summary.wall_time:.1f}",
        f"{summary.point_steps_per_second / 1e6:.2f}",
    )


def _run_section(folder: Path) -> Section:
    captions = {"final.png": "At the end", "snapshots.png": "At equal shares of the runout"}
    figures = []
    for path in write_run_pictures(folder):
        if path.name in captions:
            figures.append(Picture(embedded(path.read_bytes()), f"{captions[path.name]}, {folder.name}."))
    return Section(folder.name, (), (), tuple(figures), f"grainlaw run {folder / SCENE_NAME} --out DIR")


def _drawn(draw: Callable[[Path], None]) -> str:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.png"
        draw(path)
        return embedded(path.read_bytes())
