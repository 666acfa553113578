"""Writing the report: one self-contained page, Markdown and JSON."""

import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader

from grainlaw.materials import atomic
from grainlaw.validation.dem.judging.fitted_laws import FittedLaw
from grainlaw.validation.dem.judging.judgement import Judgement
from grainlaw.validation.dem.judging.laws_against_grains import Report
from grainlaw.validation.grains.distance import Verdict
from grainlaw.validation.reference.reference_set import Rows, Scatter
from grainlaw.validation.report.grain_sections import Section, sections
from grainlaw.validation.report.grain_tables import SYMBOLS
from grainlaw.validation.report.stored import SECTIONS, sections_as_json

PAGE, MARKDOWN, RESULT = "dem.html", "dem.md", "dem.json"
TITLE = "Laws against grains"


def write_report(folder: Path, report: Report, shear: Rows, command: str) -> list[Path]:
    """Write page, Markdown, JSON and what `grainlaw report` needs into a folder; returns their paths."""
    parts = sections(report, shear)
    texts = {
        PAGE: rendered("dem.html", TITLE, _introduction(report), parts, command),
        MARKDOWN: rendered("dem.md", TITLE, _introduction(report), parts, command),
        RESULT: json.dumps(_content(report, command), indent=2, allow_nan=False) + "\n",
        SECTIONS: sections_as_json(TITLE, command, parts),
    }
    for name, text in texts.items():
        atomic.write_text(folder / name, text)
    return [folder / name for name in texts]


def rendered(template: str, title: str, introduction: Sequence[str], parts: Sequence[Section], command: str) -> str:
    """A page, or the same in Markdown, of sections."""
    loader = PackageLoader("grainlaw.validation.report")
    environment = Environment(loader=loader, autoescape=template.endswith(".html"), trim_blocks=True)
    page = environment.get_template(template).render(
        title=title,
        introduction=introduction,
        sections=parts,
        verdicts=[str(found) for found in Verdict],
        command=command,
    )
    return page.strip() + "\n"


def _introduction(report: Report) -> list[str]:
    runs = sum(len(ensemble.runs) for ensemble in report.columns)
    return [
        f"grainlaw {version('grainlaw')}, {report.effort}: {len(report.laws)} laws on {len(report.columns)} columns "
        f"against {runs} runs of grains; cells of {report.cell_size * 1e3:g} mm.",
        "Each law is fitted to plane shear and isotropic compression of the grains and used unchanged in the collapse "
        "of a column of the same grains. Its distance to them is judged against their own scatter.",
    ]


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
        "judgements": [_judgement(found) for found in report.judgements],
        "controls": [_judgement(found) for found in report.controls],
        "limits": [_judgement(found) for found in report.limits],
        "experiment": None if report.experiment is None else [asdict(one) for one in report.experiment.measurements],
    }


def _scatter(found: Scatter) -> dict[str, Any]:
    return {
        "kind": found.kind,
        "case": found.case,
        "pairs": len(found.pairs),
        "mean": {symbol: _number(found.mean(number)) for number, symbol in enumerate(SYMBOLS)},
        "largest": {symbol: _number(found.largest(number)) for number, symbol in enumerate(SYMBOLS)},
    }


def _law(found: FittedLaw) -> dict[str, Any]:
    return {
        "law": found.judged.law,
        "title": found.judged.title,
        "parameters": found.parameters,
        "intervals_95": {one.name: [_number(one.lower), _number(one.upper)] for one in found.estimates},
        "remarks": list(found.remarks),
        "command": found.command,
        "limits": found.judged.limits,
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
            "distances": {one.symbol: _number(one.distance) for one in comparison.distances},
            "measured": {one.symbol: _number(one.measured) for one in comparison.distances},
            "grains": {one.symbol: _number(one.reference) for one in comparison.distances},
            "times": comparison.times.tolist(),
            "E_A": comparison.profiles.tolist(),
            "cpu_time": found.observation.description["cpu_time"],
            "points": found.observation.description["points"],
            "steps": found.observation.description["steps"],
        }
    return content


def _number(value: float) -> float | None:
    """JSON has no NaN and no infinity."""
    return value if math.isfinite(value) else None
