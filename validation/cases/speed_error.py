"""What accuracy costs, and whether the settings of `accuracy` keep their word on a column they were not chosen on."""

from pathlib import Path

from mpm_core.accuracy import PRESETS
from validation.case import Case, Effort, Evidence, Figure, Measurement, curve, upper_bound
from validation.collapses import SCENES
from validation.speed_error.front import error, pareto_front
from validation.speed_error.setting import Outcome, Setting
from validation.speed_error.store import outcomes
from validation.speed_error.sweep import REFERENCE_CELL, reference, settings

# Outcomes stay here: a sweep that was stopped goes on, and one made with other kernels has to be deleted by hand.
FOLDER = Path("runs/speed_error")
MATERIAL, BAND = "mu(I)-LC", 0.1
PRESET = PRESETS["mu_i_lc"]["10%"]
# The low column is 0.4 m high; this is the largest cell up to a twelfth of it that divides the domain.
PRESET_CELL, CONTROL_CELL = 1.0 / 30.0, 0.1
REFERENCE_CELLS = {Effort.QUICK: 0.0125, Effort.FULL: REFERENCE_CELL}


def measured(effort: Effort, cell_size: float) -> tuple[Measurement, ...]:
    """The observables of the low column on cells of a size against those on the finest ones."""
    one, fine = (Setting(MATERIAL, "low", size, PRESET.safety) for size in (cell_size, REFERENCE_CELLS[effort]))
    found = outcomes(FOLDER, (one, fine))
    coarse, exact = found[one], found[fine]
    return (upper_bound("largest error on the low column", "1", _error(coarse, exact), BAND),)


def measure(effort: Effort) -> Evidence:
    """The preset; in full also the sweep over all settings and materials."""
    if effort is Effort.QUICK:
        return Evidence(measured(effort, PRESET_CELL))
    figures, notes = [], []
    for material in SCENES:
        goal = reference(material, "paper")
        found = outcomes(FOLDER, settings(material))
        front = pareto_front(found, goal)
        exact = found[goal]
        rest = [(o.cpu_time, _error(o, exact)) for s, o in found.items() if o is not None and s != goal]
        curves = (
            curve("front", [cost for _, cost, _ in front], [size for _, _, size in front], "reference"),
            curve("all settings", [cost for cost, _ in rest], [size for _, size in rest]),
        )
        figures.append(Figure(f"Error over time, {material}", "processor time [s]", "error", curves, "xy"))
        notes += [f"{setting.key}: {cost:.1f} s, error {size:.1%}" for setting, cost, size in front]
    return Evidence(measured(effort, PRESET_CELL), figures=tuple(figures), notes=tuple(notes))


def control(effort: Effort) -> tuple[Measurement, ...]:
    """A third of the cells."""
    return measured(effort, CONTROL_CELL)


def _error(one: Outcome | None, exact: Outcome | None) -> float:
    return float("nan") if one is None or exact is None else error(one, exact)


CASE = Case(
    name="speed_error",
    title="column collapses with many settings, errors over processor time",
    proves="a scene with accuracy = '10%' is that close to a finer grid, on a column on which it was not chosen",
    reference="the same collapse on the finest grid, at t = 1.5 s",
    norm="largest relative difference of runout and height of 98 % of the mass and centre of mass",
    mistake="a third of the cells across the column",
    measure=measure,
    control=control,
)
