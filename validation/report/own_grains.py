"""A user's runs against a user's grains."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from grainlaw.validation.dem.judging.judgement import Judgement
from grainlaw.validation.grains.distance import compare
from grainlaw.validation.grains.reference_file import load_reference
from grainlaw.validation.grains.run_observation import diameter_of_run, observe_run
from grainlaw.validation.reference.reference_set import Ensemble
from grainlaw.validation.report.grain_sections import column_figures
from grainlaw.validation.report.grain_tables import comparison_table, profile_table
from grainlaw.validation.report.page import SECTIONS, Page, Section
from grainlaw.validation.report.write import write_texts

PAGE, TITLE = "comparison.html", "Runs against grains"


def judged_runs(folders: Sequence[Path], references: Sequence[Path]) -> tuple[Ensemble, list[Judgement]]:
    """Each run against all references, observed with the kernel of the references.

    Raises InputError in one line for whatever cannot be read, and for columns of different size.
    """
    diameters = {diameter_of_run(folder) for folder in folders}
    diameter = diameters.pop() if len(diameters) == 1 else None
    observed = [load_reference(path, diameter) for path in references]
    width = float(np.mean([reference.description["kernel_width"] for reference in observed]))
    densities = {float(found) for reference in observed if (found := reference.description.get("grain_density"))}
    density = densities.pop() if len(densities) == 1 else None
    space = observed[0].space
    ensemble = Ensemble(" and ".join(reference.label for reference in observed), tuple(observed))
    judgements = []
    for folder in folders:
        run = observe_run(folder, width, density, space)
        judgements.append(Judgement(folder.name, ensemble, run, compare(run, observed)))
    return ensemble, judgements


def grains_section(ensemble: Ensemble, judgements: Sequence[Judgement]) -> Section:
    """The tables and the figures of a page."""
    table = comparison_table(ensemble, judgements)
    figures = column_figures(ensemble, judgements)
    return Section(table.title, tables=(table, profile_table(judgements)), figures=figures)


def write_page(folder: Path, title: str, sections: Sequence[Section], command: str) -> Path:
    """Write a self-contained page with the tables and the figures that `command` makes; returns its path."""
    page = Page(title, (), tuple(sections), command)
    write_texts(folder, {PAGE: page.html(), SECTIONS: page.json()})
    return folder / PAGE
