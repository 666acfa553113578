"""One page from folders of runs and of comparisons."""

from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.run_folder import SCENE_NAME
from grainlaw.validation.report.page import SECTIONS, Page, Section, read_page
from grainlaw.validation.report.run_sections import run_sections
from grainlaw.validation.report.write import write_texts

NAME, TITLE = "report", "Runs and comparisons"


def write_whole_report(folders: Sequence[Path], out: Path) -> list[Path]:
    """Write report.html, report.md and report.json into a folder; returns their paths.

    Raises InputError in one line for a folder that is neither a finished run nor a comparison; nothing is then written.
    """
    sections, titles = _sections(folders)
    command = f"grainlaw report {' '.join(str(folder) for folder in folders)}"
    page = Page(TITLE, (f"grainlaw {version('grainlaw')}: {', '.join(titles)}.",), tuple(sections), command)
    texts = {f"{NAME}.html": page.html(), f"{NAME}.md": page.markdown(), f"{NAME}.json": page.json()}
    return write_texts(out, texts)


def _sections(folders: Sequence[Path]) -> tuple[list[Section], list[str]]:
    runs = [folder for folder in folders if _kind(folder) == "run"]
    sections = run_sections(runs) if runs else []
    titles = [folder.name for folder in runs]
    compared = [folder for folder in folders if folder not in runs]
    for folder in compared:
        page = read_page(folder)
        titles.append(f"{page.title} ({folder.name})")
        prefix = f"{folder.name}: " if len(compared) > 1 else ""
        sections += [replace(part, title=prefix + part.title) for part in page.sections]
    return sections, titles


def _kind(folder: Path) -> str:
    if not folder.is_dir():
        raise InputError(f"{folder} is no folder")
    if (folder / SECTIONS).is_file():
        return "comparison"
    if (folder / SCENE_NAME).is_file():
        return "run"
    raise InputError(
        f"{folder} holds neither a run ({SCENE_NAME}) nor a report of validate dem or compare --dem ({SECTIONS})"
    )
