"""What a data file of `grainlaw calibrate` may hold: tests with columns and settings, measured quantities."""

from grainlaw.materials.calibration.experiments import EXPERIMENTS, Experiment
from grainlaw.materials.calibration.quantities import QUANTITIES
from grainlaw.materials.declarations import Parameter, declared_fields
from grainlaw.reference.markdown import code, table


def experiment_tables() -> str:
    """Every test: the columns that may drive it, and its settings."""
    parts = []
    for experiment in EXPERIMENTS.values():
        parts += [f"### {experiment.name}\n", f"{experiment.summary[0].upper()}{experiment.summary[1:]}.\n"]
        parts.append(_rows(experiment))
    return "\n".join(parts)


def quantity_table() -> str:
    """Every quantity that may be measured."""
    return table(["column", "unit", "meaning"], [[code(name), q.unit, q.doc] for name, q in QUANTITIES.items()])


def _rows(experiment: Experiment) -> str:
    defaults = experiment.settings._field_defaults
    driving = [
        [code(name), "drives the test", found.unit, "", found.doc] for name, found in experiment.controls.items()
    ]
    driving += [
        [code(name), "what it drives, over time", found.unit, "", found.doc]
        for name, found in experiment.follows.items()
    ]
    settings = [
        [code(name), "setting", found.unit, f"{defaults[name]:g}", found.doc]
        for name, found in declared_fields(experiment.settings, Parameter).items()
    ]
    return table(["name", "use", "unit", "default", "meaning"], [*driving, *settings])
