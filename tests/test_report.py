"""`grainlaw report`: one page of runs and comparisons, from what lies in their folders."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from grainlaw.cli.main import app
from grainlaw.mpm_core import Scene, run
from grainlaw.validation.report.own_grains import TITLE, grains_section, judged_runs, write_page
from grainlaw.validation.report.page import SECTIONS, read_page
from grainlaw.validation.report.whole_report import write_whole_report

GRAINS = Path(__file__).parent / "small_collapse"
COMMAND = "grainlaw compare column --dem grains --out against"
SMALL = {"grid.cell_size": 0.05, "body.0.shape.upper": [0.15, 0.15], "time.end": 0.3}


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    root = tmp_path_factory.mktemp("report")
    scene = Path(__file__).resolve().parents[1] / "scenes" / "dem_column.toml"
    run(Scene.load(scene, SMALL), root / "column")
    ensemble, judgements = judged_runs([root / "column"], [GRAINS])
    (root / "against").mkdir()
    write_page(root / "against", TITLE, [grains_section(ensemble, judgements)], COMMAND)
    return root / "column", root / "against"


def test_runs_and_comparisons_make_one_page_without_other_files(folders, tmp_path):
    html, markdown, content = write_whole_report(folders, tmp_path)
    page = html.read_text()
    # Of an address; the letters alone come up by chance in the encoded pictures.
    assert "://" not in page
    assert page.count('<img src="data:image/png;base64,') == page.count("<img") >= 5
    # Every figure names the command that makes it.
    assert page.count(COMMAND) == 3
    assert "| column | mu_i_lc |" in markdown.read_text()
    titles = [part["title"] for part in json.loads(content.read_text())["sections"]]
    assert titles == ["Runs", "column", "Runs against grains"]


def test_a_report_of_a_report_keeps_its_tables(folders, tmp_path):
    _, against = folders
    write_whole_report([against], tmp_path)
    page = read_page(against)
    assert (page.title, page.command) == ("Runs against grains", COMMAND)
    assert page.sections[0].tables[0].rows[0][0] == "column"


@pytest.mark.parametrize(
    ("content", "message"),
    [("{", "cannot be read"), ('{"format": 0}', "has the format 0"), ('{"format": 1}', "cannot be read")],
)
def test_damaged_sections_are_refused_in_one_line_and_nothing_is_written(tmp_path, content, message):
    folder = tmp_path / "broken"
    folder.mkdir()
    (folder / SECTIONS).write_text(content)
    answer = CliRunner().invoke(app, ["report", str(folder), "--out", str(tmp_path / "out")])
    assert message in str(answer.exception)
    assert "\n" not in str(answer.exception)
    assert list((tmp_path / "out").iterdir()) == []


def test_a_folder_that_is_no_run_is_refused(tmp_path):
    answer = CliRunner().invoke(app, ["report", str(tmp_path), "--out", str(tmp_path / "out")])
    assert "neither a run" in str(answer.exception)
