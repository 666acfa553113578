"""A page of sections with text, tables and figures: one source for HTML, Markdown, JSON and the terminal."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader

from grainlaw.materials import InputError
from grainlaw.validation.grains.distance import Verdict
from grainlaw.validation.report.write import as_json

SECTIONS = "sections.json"
FORMAT = 1
# Cells of a table that are verdicts, and how they are coloured.
PASS, FAIL, WITHIN, OUTSIDE = "pass", "FAIL", "within", "OUTSIDE"
MARKS: Mapping[str, str] = {
    PASS: "good",
    WITHIN: "good",
    FAIL: "bad",
    OUTSIDE: "bad",
    Verdict.INDISTINGUISHABLE: "good",
    Verdict.ACCEPTABLE: "fair",
    Verdict.DIFFERS: "bad",
}


@dataclass(frozen=True)
class Table:
    """A heading, names of the columns and rows of text; cells of `MARKS` are coloured, titles of sections are links."""

    title: str
    note: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Picture:
    """An image as a data URI, and what it shows."""

    image: str
    caption: str


@dataclass(frozen=True)
class Section:
    """A part of the page; `command` makes its figures, where it is not the page's own."""

    title: str
    paragraphs: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    figures: tuple[Picture, ...] = ()
    command: str = ""


@dataclass(frozen=True)
class Page:
    """Everything on a page, and the command that makes it."""

    title: str
    introduction: tuple[str, ...]
    sections: tuple[Section, ...]
    command: str

    def html(self) -> str:
        """One file that needs no other."""
        return self._rendered("page.html")

    def markdown(self) -> str:
        """The same without figures."""
        return self._rendered("page.md")

    def json(self) -> str:
        """The sections with their figures, from which `grainlaw report` shows them again without computing anything."""
        parts = [asdict(part) for part in self.sections]
        return as_json({"format": FORMAT, "title": self.title, "command": self.command, "sections": parts})

    def _rendered(self, template: str) -> str:
        loader = PackageLoader("grainlaw.validation.report")
        environment = Environment(
            loader=loader, autoescape=template.endswith(".html"), trim_blocks=True, lstrip_blocks=True
        )
        anchors = {part.title for part in self.sections}
        return environment.get_template(template).render(page=self, marks=MARKS, anchors=anchors).strip() + "\n"


def read_page(folder: Path) -> Page:
    """The page whose sections lie in a folder. Raises InputError in one line for a damaged file or an older format."""
    path = folder / SECTIONS
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise InputError(f"{path} has the format {content['format']}, this version reads {FORMAT}")
        sections = tuple(_section(part, content["command"]) for part in content["sections"])
        return Page(content["title"], (), sections, content["command"])
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
        tuple(Picture(figure["image"], figure["caption"]) for figure in part["figures"]),
        part["command"] or command,
    )
