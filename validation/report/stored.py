"""Sections of a page as JSON beside it, so that `grainlaw report` shows them again without computing anything."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from grainlaw.materials import InputError
from grainlaw.validation.report.grain_sections import ReportFigure, Section
from grainlaw.validation.report.grain_tables import Table

SECTIONS = "sections.json"
FORMAT = 1


def sections_as_json(title: str, command: str, sections: Sequence[Section]) -> str:
    """Title, command and sections, with their figures."""
    content = {"format": FORMAT, "title": title, "command": command, "sections": [asdict(part) for part in sections]}
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def read_sections(folder: Path) -> tuple[str, str, list[Section]]:
    """Title, command and sections of a folder. Raises InputError in one line for a damaged file or an older format."""
    path = folder / SECTIONS
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise InputError(f"{path} has the format {content['format']}, this version reads {FORMAT}")
        return (
            content["title"],
            content["command"],
            [_section(part, content["command"]) for part in content["sections"]],
        )
    except (OSError, UnicodeDecodeError, json.JSONDecodeError, KeyError, TypeError) as error:
        raise InputError(f"{path} cannot be read as the sections of a report: {error}") from None


def _section(part: dict[str, Any], command: str) -> Section:
    return Section(
        part["title"],
        tuple(part["paragraphs"]),
        tuple(
            Table(table["title"], table["note"], tuple(table["columns"]), tuple(tuple(row) for row in table["rows"]))
            for table in part["tables"]
        ),
        tuple(ReportFigure(figure["image"], figure["caption"]) for figure in part["figures"]),
        part["command"] or command,
    )
