"""The documentation is what the code says: generated parts are up to date, and every shown command works."""

import re
import shlex
import subprocess
import sys
import typing
from pathlib import Path
from typing import Any

import pytest
import typer
from documentation import DOCS, ROOT, page_script, run_page
from pydantic import BaseModel

from grainlaw.cli.main import app
from grainlaw.mpm_core.output.recorder import OWN_FILES
from grainlaw.mpm_core.output.summary import RunSummary
from grainlaw.reference.command_page import commands
from grainlaw.reference.law_curves import picture
from grainlaw.reference.law_pages import own_laws
from grainlaw.reference.pages import PARTS, regenerated_pages
from grainlaw.reference.scene_tables import description, models_in, scene_tables

PAGES = sorted(DOCS.glob("*.md"))
RUNNABLE = re.compile(r"^```(sh|python) runnable$", re.M)
# test_template_package.py follows adding-a-law.md in an environment of its own.
RUNNABLE_PAGES = [
    page
    for page in (ROOT / "README.md", *PAGES)
    if page.name != "adding-a-law.md" and RUNNABLE.search(page.read_text(encoding="utf-8"))
]
COMMANDS: dict[str, Any] = commands(typer.main.get_command(app))


def test_generated_parts_are_up_to_date():
    for path, text in regenerated_pages(DOCS).items():
        assert path.read_text(encoding="utf-8") == text, f"{path.name} is out of date: run `make docs`"


def test_every_generated_part_stands_on_a_page():
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    assert [name for name in PARTS if f"<!-- end of {name} -->" not in text] == []


def test_each_law_has_a_page_and_each_page_a_law():
    assert {path.stem for path in (DOCS / "laws").iterdir()} == {law.name for law in own_laws()}


@pytest.mark.parametrize("law", [law.name for law in own_laws()])
def test_each_law_has_its_curves_in_a_small_picture(law):
    path = DOCS / picture(law)
    content = path.read_bytes()
    assert content.startswith(b"\x89PNG")
    assert len(content) < 60_000


def test_the_command_on_a_law_s_page_draws_its_picture(tmp_path):
    page = (DOCS / "laws" / "linear_elastic.md").read_text(encoding="utf-8")
    (line,) = re.findall(r"^grainlaw element .*$", page, re.M)
    subprocess.run([sys.executable, "-m", *shlex.split(line)], cwd=tmp_path, check=True, capture_output=True)
    assert (tmp_path / "linear_elastic.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_is_documented(name):
    page = (DOCS / "command-line.md").read_text(encoding="utf-8")
    section = page.partition(f"## grainlaw {name}\n")[2].partition("\n## ")[0]
    for parameter in COMMANDS[name].params:
        assert parameter.help, f"{name}: {parameter.name} has no help text"
        shown = parameter.opts[0] if parameter.param_type_name == "option" else parameter.metavar or parameter.name
        assert shown.casefold() in section.casefold()


def test_every_scene_key_is_documented():
    page = (DOCS / "scenes.md").read_text(encoding="utf-8")
    for entry in scene_tables():
        for name, info in entry.model.model_fields.items():
            only_one_value = len(typing.get_args(info.annotation)) == 1 and name == "kind"
            assert description(info) or only_one_value, f"{entry.model.__name__}.{name} has no description"
            assert f"| `{name}` |" in page


def test_every_model_of_a_scene_is_in_the_reference():
    from grainlaw.mpm_core.scene.model import Scene

    def nested(model: type[BaseModel]) -> set[type[BaseModel]]:
        inner = {part for info in model.model_fields.values() for part in models_in(info.annotation)}
        return {model}.union(*(nested(part) for part in inner))

    assert {entry.model for entry in scene_tables()} == nested(Scene)


def test_every_file_of_a_run_is_documented():
    page = (DOCS / "output.md").read_text(encoding="utf-8").replace("NNNNNN", "*")
    assert [name for name in OWN_FILES if f"| `{name}` |" not in page] == []


def test_keys_of_the_summary_are_documented():
    section = (DOCS / "output.md").read_text(encoding="utf-8").partition("## Keys of summary.json")[2]
    keys = set()
    for name, info in RunSummary.model_fields.items():
        inner = next(models_in(info.annotation), None)
        keys |= {f"{name}.{key}" for key in inner.model_fields} if inner else {name}
    assert set(re.findall(r"^\| `([\w.]+)` \|", section, re.M)) == keys


def test_links_lead_somewhere():
    pages = [ROOT / "README.md", *PAGES, *(DOCS / "laws").iterdir()]
    for page in pages:
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page.name} links to {target}"


@pytest.mark.parametrize("page", RUNNABLE_PAGES, ids=lambda page: page.stem)
def test_commands_of_a_page_work(page: Path, tmp_path: Path):
    run_page(page, tmp_path / "clone")


def test_pages_show_commands_to_run():
    assert {page.stem for page in RUNNABLE_PAGES} >= {
        "README",
        "calibration",
        "command-line",
        "element-tests",
        "output",
        "physics-notes",
        "python",
        "quick-start",
        "scenes",
    }
    assert "grainlaw run" in page_script(DOCS / "adding-a-law.md")
