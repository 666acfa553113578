"""What the page says, in its order: the scatter of the grains first, then what was fitted, judged and left out."""

from collections.abc import Sequence

from grainlaw.validation.case import Evidence
from grainlaw.validation.cases.collapses import aluminium_bars
from grainlaw.validation.dem.judging.judgement import Judgement
from grainlaw.validation.dem.judging.laws_against_grains import FLAT, Report
from grainlaw.validation.grains.distance import PROFILE_BAND
from grainlaw.validation.reference.reference_set import Ensemble, Rows
from grainlaw.validation.report.case_report import measurement_table, pictures
from grainlaw.validation.report.element_figure import element_figure
from grainlaw.validation.report.grain_figures import (
    distance_figure,
    profile_figure,
    series_figure,
    shear_figure,
    stress_figure,
)
from grainlaw.validation.report.grain_tables import (
    cost_table,
    coverage_table,
    element_table,
    parameter_table,
    profile_table,
    scatter_table,
    summary_table,
    variant_table,
    verdict_table,
)
from grainlaw.validation.report.page import Picture, Section

MODELLED = (
    "Both sides are observed by the same functions. Solid fraction: each grain, or material point, is spread by a "
    "Gaussian whose standard deviation is one mean grain diameter over cells of 7.5 mm, mirrored at the floor. Surface "
    "h(x): the highest level where the solid fraction falls through half of that of the packing before the release. "
    "Runout w: half of the width over which h exceeds one grain diameter. H: the largest h. t50: when half of the "
    "growth of the runout is reached. E_A: area between two surfaces over the mean area below them. phi: mean solid "
    "fraction two diameters below the surface and one above the floor. Cylinders: the same around their axis; w is the "
    "radius of the pile, E_A the volume between two surfaces over the mean volume below them."
)
CONTINUUM = (
    "The continuum starts with the mass and the mean surface of the packing at rest under its own weight, with equal "
    "normal stresses, on a floor with friction 0.7, that of the contacts, and on a flat one with the friction that "
    "plane shear over a plane shows; by symmetry half of the column is run, in plane strain, and of a cylinder a "
    "radian, in axisymmetry."
)
LEFT_OUT = (
    "Left out of the continuum: the rolling of grains on the floor, the layering of grains at smooth walls before the "
    "release, the depth of four grains between periodic sides, and whatever a law does not describe (see its limits). "
    "Left out of the grains: shapes other than spheres, air, cohesion."
)


def sections(report: Report, shear: Rows) -> list[Section]:
    """All parts of the page."""
    scatter = scatter_table(report.scatter)
    controls = variant_table(
        "Negative controls",
        "One mistake each: mu(I)-LC and mu(I), state must come out as differs; mu(I), phi(I), and mu(I), state under "
        "another gravity, as no longer indistinguishable.",
        report.controls,
    )
    parts = [
        Section(scatter.title, tables=(scatter,)),
        Section("Verdicts", tables=(summary_table(report),)),
        _fits(report, shear),
        Section("Element tests", tables=(element_table(report.elements),), figures=_element_pictures(report)),
        *(_column(report, ensemble) for ensemble in (*report.columns, *report.flat_columns)),
        Section(controls.title, (_controls_said(report),), (controls,)),
    ]
    if report.limits:
        note = "Laws with one thing changed, nothing refitted: what moves towards the grains is what limits them."
        parts.append(
            Section("What limits the laws", tables=(variant_table("What limits the laws", note, report.limits),))
        )
    if report.experiment is not None:
        parts.append(_experiment(report.experiment))
    cost = cost_table(report)
    runs = coverage_table()
    parts += [
        Section(cost.title, tables=(cost,)),
        Section(runs.title, tables=(runs,)),
        Section("What was modelled", (MODELLED, CONTINUUM, LEFT_OUT)),
    ]
    return parts


def _controls_said(report: Report) -> str:
    if not report.missed:
        return "All of them are noticed."
    return f"NOT all of them are noticed: {', '.join(found.name for found in report.missed)}."


def _fits(report: Report, shear: Rows) -> Section:
    table = parameter_table(report.laws)
    remarks = [f"{law.judged.title}: {remark}." for law in report.laws for remark in law.remarks]
    commands = [f"{law.judged.title}: in the folder data, {law.command}" for law in report.laws]
    image = shear_figure(shear, {law.judged.title: law.curve for law in report.laws})
    caption = "Plane shear of the grains: friction over the mean pressure and solid fraction; fitted laws."
    return Section(table.title, (*remarks, *commands), (table,), (Picture(image, caption),))


def _experiment(found: Evidence) -> Section:
    """The solver against an experiment that it has nothing in common with."""
    case = aluminium_bars.CASE
    paragraphs = (f"The solver, {case.proves}. {case.reference}.", *(f"{note}." for note in found.notes))
    table = measurement_table(found.measurements, note=case.norm)
    command = f"grainlaw validate {case.name} --out DIR"
    return Section("A published experiment: aluminium bars", paragraphs, (table,), pictures(case, found), command)


def _element_pictures(report: Report) -> tuple[Picture, ...]:
    image = element_figure(report.elements)
    return (Picture(image, "Element tests: grains, dots, and the fitted laws."),) if image else ()


def _column(report: Report, ensemble: Ensemble) -> Section:
    judgements = report.of_column(ensemble)
    table = verdict_table(ensemble, judgements)
    tables, figures = (table, profile_table(judgements)), column_figures(ensemble, judgements)
    said = (f"The floor of the laws has the friction {report.flat_friction:.2f}.",) if ensemble.floor == FLAT else ()
    return Section(table.title, said, tables, figures)


def column_figures(ensemble: Ensemble, judgements: Sequence[Judgement]) -> tuple[Picture, ...]:
    """Surfaces, series and E_A over time on one column."""
    name = ensemble.case
    return (
        Picture(profile_figure(ensemble, judgements), f"Surfaces over time, {name}."),
        Picture(series_figure(ensemble, judgements), f"Runout, height, energy, solid fraction, {name}."),
        *_stress_figures(ensemble, judgements),
        Picture(
            distance_figure(judgements, PROFILE_BAND),
            f"E_A over time, {name}; green: indistinguishable, yellow: acceptable; shaded: nearest to farthest.",
        ),
    )


def _stress_figures(ensemble: Ensemble, judgements: Sequence[Judgement]) -> tuple[Picture, ...]:
    """Stress along the axis, where runs of the grains tell their contacts."""
    if not any("stress_zz" in run.snapshots for run in ensemble.runs):
        return ()
    caption = f"Stress along the axis, {ensemble.case}; forces between the grains, no fluctuations."
    return (Picture(stress_figure(ensemble, judgements), caption),)
