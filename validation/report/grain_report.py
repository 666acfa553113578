"""Writing the report: one self-contained page, Markdown and JSON."""

from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

from grainlaw.validation.dem.judging.element_verdicts import ElementVerdict
from grainlaw.validation.dem.judging.fitted_laws import FittedLaw
from grainlaw.validation.dem.judging.judgement import Judgement
from grainlaw.validation.dem.judging.laws_against_grains import Report
from grainlaw.validation.reference.reference_set import Rows, Scatter
from grainlaw.validation.report.grain_sections import sections
from grainlaw.validation.report.grain_tables import SYMBOLS
from grainlaw.validation.report.page import SECTIONS, Page
from grainlaw.validation.report.write import as_json, write_texts

PAGE, MARKDOWN, RESULT = "dem.html", "dem.md", "dem.json"
TITLE = "Laws against grains"


def write_report(folder: Path, report: Report, shear: Rows, command: str) -> list[Path]:
    """Write page, Markdown, JSON and what `grainlaw report` needs into a folder; returns their paths."""
    page = Page(TITLE, _introduction(report), tuple(sections(report, shear)), command)
    texts = {
        PAGE: page.html(),
        MARKDOWN: page.markdown(),
        RESULT: as_json(_content(report, command)),
        SECTIONS: page.json(),
    }
    return write_texts(folder, texts)


def _introduction(report: Report) -> tuple[str, ...]:
    runs = sum(len(ensemble.runs) for ensemble in report.columns)
    return (
        f"grainlaw {version('grainlaw')}, {report.effort}: {len(report.laws)} laws on {len(report.columns)} columns "
        f"against {runs} runs of grains; cells of {report.cell_size * 1e3:g} mm.",
        "Each law is fitted to plane shear and isotropic compression of the grains and used unchanged in the collapse "
        "of a column of the same grains. Its distance to them is judged against their own scatter.",
    )


def _content(report: Report, command: str) -> dict[str, Any]:
    return {
        "version": version("grainlaw"),
        "command": command,
        "effort": str(report.effort),
        "cell_size": report.cell_size,
        "controls_noticed": not report.missed,
        "scatter": [_scatter(found) for found in report.scatter],
        "laws": [_law(found) for found in report.laws],
        "unfitted": report.unfitted,
        "element_tests": [_elements(found) for found in report.elements],
        "judgements": [_judgement(found) for found in report.judgements],
        "flat_floors": [_judgement(found) for found in report.flat],
        "flat_floor_friction": report.flat_friction,
        "controls": [_judgement(found) for found in report.controls],
        "limits": [_judgement(found) for found in report.limits],
        "experiment": None if report.experiment is None else [asdict(one) for one in report.experiment.measurements],
    }


def _scatter(found: Scatter) -> dict[str, Any]:
    return {
        "kind": found.kind,
        "case": found.case,
        "pairs": len(found.pairs),
        "mean": {symbol: found.mean(number) for number, symbol in enumerate(SYMBOLS)},
        "largest": {symbol: found.largest(number) for number, symbol in enumerate(SYMBOLS)},
    }


def _law(found: FittedLaw) -> dict[str, Any]:
    return {
        "law": found.judged.law,
        "title": found.judged.title,
        "parameters": found.parameters,
        "intervals_95": {one.name: [one.lower, one.upper] for one in found.estimates},
        "remarks": list(found.remarks),
        "command": found.command,
        "limits": found.judged.limits,
    }


def _elements(found: ElementVerdict) -> dict[str, Any]:
    return {
        "name": found.title,
        "distances": {one.name: one.distance for one in found.distances},
        "verdicts": {one.name: str(one.verdict) for one in found.distances},
        "failures": list(found.failures),
    }


def _judgement(found: Judgement) -> dict[str, Any]:
    comparison = found.comparison
    content: dict[str, Any] = {
        "name": found.name,
        "case": found.ensemble.case,
        "verdict": str(found.verdict),
        "failure": found.failure,
    }
    if comparison is not None and found.observation is not None:
        content |= {
            "distances": {one.symbol: one.distance for one in comparison.distances},
            "measured": {one.symbol: one.measured for one in comparison.distances},
            "grains": {one.symbol: one.reference for one in comparison.distances},
            "times": comparison.times.tolist(),
            "E_A": comparison.profiles.tolist(),
            "cpu_time": found.observation.description["cpu_time"],
            "points": found.observation.description["points"],
            "steps": found.observation.description["steps"],
        }
    return content
