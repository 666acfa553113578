"""What accuracy costs, and whether the settings of `accuracy` keep their word on a column they were not chosen on."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from grainlaw.mpm_core.scene.model import Scene
from grainlaw.mpm_core.scene.shipped import shipped_scenes
from grainlaw.validation.case import Case, Effort, Evidence, Figure, Measurement, curve, upper_bound
from grainlaw.validation.cases.collapses.column import SCENES
from grainlaw.validation.cases.speed.exact import cost_and_error, exact_settings
from grainlaw.validation.cases.speed.front import error, mean_observables, pareto_front
from grainlaw.validation.cases.speed.setting import COLUMNS, Outcome, Setting
from grainlaw.validation.cases.speed.store import made_with_other_kernels, outcomes
from grainlaw.validation.cases.speed.sweep import references, settings

# Outcomes stay here: a sweep that was stopped goes on, and the report says how many were made with other kernels.
FOLDER = Path("runs/speed_error")
# (material, accuracy, column on which it was not chosen)
PROMISES = {
    Effort.QUICK: (("mu(I)-LC", "10%", "slim"),),
    Effort.FULL: (
        ("mu(I)-LC", "10%", "slim"),
        ("mu(I)-LC", "3%", "slim"),
        ("MCC OCR 1", "10%", "low"),
    ),
}
# In quick effort [m].
COARSE_REFERENCE = (1.0 / 60.0, 1.0 / 70.0)

COARSE_CELL = 0.2

# Times and errors of named settings.
Costs = dict[str, tuple[float, float]]


def measured(effort: Effort, cell_size: float | None = None) -> tuple[Measurement, ...]:
    """The observables of each column with the cells of an accuracy against those on the finest ones."""
    found = []
    for material, accuracy, column in PROMISES[effort]:
        cells = COARSE_REFERENCE if effort is Effort.QUICK else None
        fine = mean_outcome(references(material, column, cells))
        (outcome,) = outcomes(FOLDER, (promised_setting(material, accuracy, column, cell_size),)).values()
        name, band = f"largest error, {material}, accuracy = {accuracy}", float(accuracy.rstrip("%")) / 100.0
        found.append(upper_bound(name, "1", error(outcome, fine), band))
    return tuple(found)


def promised_setting(material: str, accuracy: str, column: str, cell_size: float | None) -> Setting:
    """What a scene with this accuracy is run with, or the same on cells of another size [m]."""
    lower, upper = COLUMNS[column]
    shape = {"kind": "rectangle", "lower": lower, "upper": upper}
    left_open = {"grid.cell_size": cell_size, "body.0.points_per_cell": None}
    changes = {"accuracy": accuracy, "body.0.shape": shape, **left_open}
    scene = Scene.load(shipped_scenes()[SCENES[material]], changes)
    chosen = scene.grid.cell_size, scene.body[0].points_per_cell, scene.time.safety
    return Setting(material, column, *chosen, precision=scene.precision)


def mean_outcome(fine: Iterable[Setting]) -> dict[str, float]:
    """The mean observables of some runs."""
    return mean_observables(outcomes(FOLDER, fine).values())


def measure(effort: Effort) -> Evidence:
    """The presets; in full also the sweep over all settings, of all materials and of the exact solution."""
    if effort is Effort.QUICK:
        return Evidence(measured(effort))
    found = {material: outcomes(FOLDER, settings(material)) for material in SCENES}
    fronts = {f"collapse, {material}": costs_of_collapse(material, found[material]) for material in SCENES}
    fronts["driven square, exact"] = costs_of_square()
    figures, notes = [], []
    for name, costs in fronts.items():
        front = pareto_front(costs)
        curves = (
            curve("front", [cost for _, cost, _ in front], [size for _, _, size in front], "reference"),
            curve("all settings", [cost for cost, _ in costs.values()], [size for _, size in costs.values()]),
        )
        figures.append(Figure(f"Error over time, {name}", "processor time [s]", "error", curves, "xy"))
        notes += [f"{name}: {setting}: {cost:.2g} s, error {size:.2g}" for setting, cost, size in front]
    others = sum(made_with_other_kernels(of_material.values()) for of_material in found.values())
    if others > 0:
        notes.append(f"{others} outcomes in {FOLDER} were made with other kernels: delete them to measure them again")
    return Evidence(measured(effort), figures=tuple(figures), notes=tuple(notes))


def costs_of_collapse(material: str, found: Mapping[Setting, Outcome | None]) -> Costs:
    """Of the paper's column with all settings that do not break down."""
    fine = mean_outcome(references(material, "paper"))
    return {
        setting.key: (outcome.cpu_time, error(outcome, fine))
        for setting, outcome in found.items()
        if outcome is not None
    }


def costs_of_square() -> Costs:
    """Of the driven square with all settings that do not break down."""
    found = {setting.words: cost_and_error(setting) for setting in exact_settings()}
    return {words: costs for words, costs in found.items() if costs is not None}


def control(effort: Effort) -> tuple[Measurement, ...]:
    """Few cells across the column."""
    return measured(effort, COARSE_CELL)


CASE = Case(
    name="speed_error",
    title="column collapses with many settings, errors over processor time",
    proves="accuracy = '10%' or '3%' is that close to finer grids, on a column that was not used to choose it",
    reference="the mean of the same collapse on the three finest grids, at t = 1.5 s",
    norm="largest relative difference of runout and height of 98 % of the mass and centre of mass",
    mistake="cells of 0.2 m, two across the column",
    measure=measure,
    control=control,
)
