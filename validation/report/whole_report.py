"""One page from folders of runs and of comparisons."""

from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

from grainlaw.materials import InputError, atomic
from grainlaw.mpm_core.output.recorder import SCENE_NAME
from grainlaw.validation.report.grain_report import rendered
from grainlaw.validation.report.grain_sections import Section
from grainlaw.validation.report.run_sections import run_sections
from grainlaw.validation.report.stored import SECTIONS, read_sections, sections_as_json

NAME, TITLE = "report", "Runs and comparisons"


def write_whole_report(folders: Sequence[Path], out: Path) -> list[Path]:
    """Write report.html, report.md and report.json into a folder; returns their paths.

    Raises InputError in one line for a folder that is neither a finished run nor a comparison; nothing is then written.
    """
    sections, titles = _sections(folders)
    command = f"grainlaw report {' '.join(str(folder) for folder in folders)}"
    introduction = (f"grainlaw {version('grainlaw')}: {', '.join(titles)}.",)
    texts = {
        f"{NAME}.html": rendered("dem.html", TITLE, introduction, sections, command),
        f"{NAME}.md": rendered("dem.md", TITLE, introduction, sections, command),
        f"{NAME}.json": sections_as_json(TITLE, command, sections),
    }
    for name, text in texts.items():
        atomic.write_text(out / name, text)
    return [out / name for name in texts]


def _sections(folders: Sequence[Path]) -> tuple[list[Section], list[str]]:
    runs = [folder for folder in folders if _kind(folder) == "run"]
    sections = run_sections(runs) if runs else []
    titles = [folder.name for folder in runs]
    compared = [folder for folder in folders if folder not in runs]
    for folder in compared:
        title, _, parts = read_sections(folder)
        titles.append(f"{title} ({folder.name})")
        prefix = f"{folder.name}: " if len(compared) > 1 else ""
        sections += [replace(part, title=prefix + part.title) for part in parts]
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
