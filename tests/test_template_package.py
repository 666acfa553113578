"""A stranger's law: docs/adding-a-law.md followed to the letter, in a virtual environment of its own.

The environment holds grainlaw as a real installation (`installation.py`).
"""

import json
import subprocess
import sys

import pytest
from documentation import DOCS, run_page
from installation import PIP_SETTINGS


@pytest.fixture(scope="module")
def followed(installation, tmp_path_factory):
    """The folder of the package that the page makes, after all its commands ran in the new environment."""
    folder = tmp_path_factory.mktemp("work")
    run_page(DOCS / "adding-a-law.md", folder / "clone", installation.binaries, PIP_SETTINGS)
    return folder / "cemented-sand"


def test_law_is_listed_as_coming_from_its_own_package(installation, followed):
    listed = subprocess.run(
        [installation.binaries / "grainlaw", "materials", "--json"],
        cwd=followed,
        capture_output=True,
        text=True,
        check=True,
    )
    assert listed.stderr == ""
    laws = {law["name"]: law for law in json.loads(listed.stdout)}
    assert laws["cemented_sand"]["origin"] == "cemented-sand 0.1.0"
    assert laws["cemented_sand"]["file"] == str(followed / "cemented_sand.py")
    assert laws["mu_i_lc"]["file"].startswith(str(installation.binaries.parent))


def test_element_tests_wrote_history_and_figure(followed):
    assert (followed / "triaxial.png").read_bytes().startswith(b"\x89PNG")
    heading, *_, last = (followed / "shear.csv").read_text().splitlines()
    values = dict(zip(heading.split(","), map(float, last.split(",")), strict=True))
    assert values["stress_xy [Pa]"] == pytest.approx(0.6 * values["pressure [Pa]"], rel=1e-6)


def test_column_collapsed_and_cohesion_held_it_back(followed):
    runout = {}
    for name in ("collapse", "loose"):
        assert (followed / name / "run.pvd").is_file()
        runout[name] = json.loads((followed / name / "summary.json").read_text())["final"]["runout"]
    assert 0.2 < runout["collapse"] < 0.8 * runout["loose"]
    assert (followed / "comparison" / "snapshots.png").read_bytes().startswith(b"\x89PNG")
    assert "plastic_shear_strain" in (followed / "collapse" / "quantities.csv").read_text()


UNWRITTEN = "    factor = 1.0 if p > 0.0 else 0.0\n"
WRITTEN = """\
    strength = parameters.critical_state_ratio * p / math.sqrt(3.0)
    factor = min(1.0, strength / max(half_norm(trial), 1e-300))
"""


def test_new_law_fails_its_test_until_it_is_written_and_then_passes_every_check(installation, tmp_path):
    def command(*arguments, folder=tmp_path / "green-sand"):
        return subprocess.run(
            [installation.binaries / arguments[0], *arguments[1:]],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )

    def tested():
        return command("python", "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_green_sand.py")

    made = command("grainlaw", "new-law", "green_sand", folder=tmp_path)
    assert made.returncode == 0, made.stderr
    law = tmp_path / "green-sand" / "green_sand.py"
    assert "coulomb" not in "".join(path.read_text() for path in law.parent.iterdir())
    unfinished = tested()
    assert "1 failed, 3 passed" in unfinished.stdout
    assert "test_large_shear_stays_on_the_yield_surface" in unfinished.stdout

    text = law.read_text()
    assert text.count(UNWRITTEN) == 1
    text = text.replace(UNWRITTEN, WRITTEN).replace("    deviator,\n", "    deviator,\n    half_norm,\n")
    law.write_text(text.replace("from typing import", "import math\nfrom typing import", 1))
    assert "4 passed" in tested().stdout
    checked = command("grainlaw", "check", "green_sand", "--quick", "--plugin", "green_sand.py")
    assert checked.returncode == 0, checked.stdout + checked.stderr
    run = command(
        "grainlaw", "run", "collapse.toml", "--plugin", "green_sand.py", "--out", "collapse",
        "--set", "grid.cell_size=0.1", "--set", "time.end=0.1",
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    assert list((law.parent / "collapse").glob("*.png"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["Green-Sand"], "'Green-Sand' is no name for a law; allowed: lower_case_with_underscores"),
        (["lambda"], "'lambda' is no name for a law"),
        (["mu_i_lc"], "the name 'mu_i_lc' is taken by grainlaw"),
        (["random"], "the name 'random' is that of another Python module"),
        (["numpy"], "the name 'numpy' is that of another Python module"),
        (["grainlaw"], "the name 'grainlaw' is that of another Python module"),
        (["green_sand", "--out", "/dev/null/green"], "/dev/null/green cannot be written: Not a directory"),
        (["green_sand", "--out", "taken"], "taken exists already; choose another folder with --out"),
    ],
)
def test_new_law_refuses_what_it_cannot_write(arguments, message, tmp_path):
    (tmp_path / "taken").mkdir()
    done = subprocess.run(
        [sys.executable, "-m", "grainlaw", "new-law", *arguments],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")
    assert message in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]
