"""Sweeps: what is varied, which runs are made, what is refused, the table, the page and how much each key matters."""

import csv
from contextlib import nullcontext

import numpy as np
import pyarrow.parquet
import pytest
from scenes_for_tests import BLOCK, changed, grainlaw, write_scene

import grainlaw as gl
from grainlaw.materials import InputError
from grainlaw.mpm_core.output.summary import read_summary
from grainlaw.studies.batch import Outcome
from grainlaw.studies.design import drawn_design, grid_design, hypercube_design, refuse_bad_values, sobol_design
from grainlaw.studies.sensitivity import indices, main_effect, rank_correlation
from grainlaw.studies.variation import variations_of

FALLING = changed(BLOCK, {"gravity": [0.0, -9.81], "time.end": 0.02, "output": {"pictures": False}})


@pytest.mark.parametrize(
    ("given", "levels"),
    [
        ("0.2:0.6:3", (0.2, 0.4, 0.6)),
        ("-1:1:2", (-1, 1)),
        ("4:16:3", (4, 10, 16)),
        ("4:9:3", (4.0, 6.5, 9.0)),
        ("1e3 : 2e3 : 2", (1000.0, 2000.0)),
        ("[1, 4]", (1, 4)),
        ("[true]", (True,)),
        ('["apic", "affine_flip"]', ("apic", "affine_flip")),
        ("[apic, affine_flip]", ("apic", "affine_flip")),
        ("[[0, -9], [1, -9]]", ([0, -9], [1, -9])),
        ([1.5, 2.5], (1.5, 2.5)),
    ],
)
def test_values_of_a_key(given, levels):
    (found,) = variations_of({"key": given})
    assert found.levels == pytest.approx(levels) if isinstance(levels[0], float) else found.levels == levels
    assert [type(level) for level in found.levels] == [type(level) for level in levels]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("0.6:0.2:3", "the range is empty; allowed: a < b"),
        ("1:1:3", "the range is empty"),
        ("1:2:1", "1 values; allowed: 2 to 10000"),
        ("1:2:3.5", "3.5 values; allowed: 2 to"),
        ("1:2:3:4", "expected KEY=a:b:n"),
        ("a:2:3", "'a' is not a number"),
        ("nan:2:3", "'nan' is not a number"),
        ("5", "expected KEY=a:b:n"),
        ("[]", "no value"),
        ("[1, 1]", "a value stands there twice"),
    ],
)
def test_what_is_no_range_is_refused_in_a_line(given, message):
    with pytest.raises(InputError, match=f"--vary key=.*{message}"):
        variations_of({"key": given})


def test_a_grid_has_all_combinations():
    found = grid_design(variations_of({"a": "0:1:2", "b": "[x, y, z]"}))
    assert found.rows == ((0, "x"), (0, "y"), (0, "z"), (1, "x"), (1, "y"), (1, "z"))
    assert found.changes()[4] == {"a": 1, "b": "y"}


def test_each_part_of_a_range_holds_one_run_of_a_hypercube():
    asked = variations_of({"a": "10:20", "b": "[1, 2]", "c": "-1:1"})
    found = hypercube_design(asked, 8, seed=3)
    a, b, c = (np.array(column) for column in zip(*found.rows, strict=True))
    assert sorted(((a - 10.0) / 10.0 * 8).astype(int)) == list(range(8))
    assert sorted(((c + 1.0) / 2.0 * 8).astype(int)) == list(range(8))
    assert sorted(b) == [1] * 4 + [2] * 4
    assert hypercube_design(asked, 8, seed=3) == found
    assert hypercube_design(asked, 8, seed=4) != found


CALIBRATED = """
static_friction = 0.5
dynamic_friction = 0.9
inertial_number_constant = 0.279
bulk_modulus = 2e4
poisson_ratio = 0.2
grain_density = 2450.0
grain_diameter = 0.005

[calibration]
law = "mu_i_lc"
sources = ["shear.csv"]
drawn = ["static_friction", "dynamic_friction"]
logarithmic = [false, false]
covariance = [[1e-4, -1e-4], [-1e-4, 4e-4]]
"""


def test_draws_follow_the_covariance_in_every_material_of_the_law(tmp_path):
    path = tmp_path / "parameters.toml"
    path.write_text(CALIBRATED)
    materials = {"sand": {"law": "mu_i_lc"}, "mu_i_lc": {}, "linear_elastic": {}}
    found = drawn_design({"material": materials}, path, 400, seed=0)
    assert found.keys == tuple(
        f"material.{name}.{key}" for name in ("sand", "mu_i_lc") for key in ("static_friction", "dynamic_friction")
    )
    rows = np.array(found.rows)
    np.testing.assert_array_equal(rows[:, :2], rows[:, 2:])
    np.testing.assert_allclose(rows.mean(axis=0)[:2], [0.5, 0.9], atol=4e-3)
    np.testing.assert_allclose(np.cov(rows[:, :2].T), [[1e-4, -1e-4], [-1e-4, 4e-4]], rtol=0.3)
    with pytest.raises(InputError, match="is of the law mu_i_lc, which no material of the scene has"):
        drawn_design({"material": {"linear_elastic": {}}}, path, 4, seed=0)


@pytest.mark.parametrize(
    ("design", "message"),
    [
        (lambda: grid_design(variations_of({"a": "0:1"})), "a=0:1: a grid needs a:b:n"),
        (lambda: hypercube_design(variations_of({"a": "0:1:3"}), 4, 0), "a=0:1:3: with samples a range is a:b"),
        (lambda: sobol_design(variations_of({"a": "0:1"}), 12, 0), "samples = 12: .* a power of two; nearest: 8 or 16"),
        (lambda: grid_design(variations_of(dict.fromkeys("abcd", "0:1:100"))), "100000000 runs; allowed: 100000"),
    ],
)
def test_designs_that_cannot_be_made_are_refused_in_a_line(design, message):
    with pytest.raises(InputError, match=message):
        design()


def test_a_value_is_refused_only_where_all_combinations_are():
    def check(values):
        if values["low"] > values["high"] or values["low"] < 0.0:
            raise InputError(f"low = {values['low']}")

    refuse_bad_values(variations_of({"low": "0:2:3", "high": "1:2:2"}), check)
    with pytest.raises(InputError, match="low = 3"):
        refuse_bad_values(variations_of({"low": "0:3:3", "high": "1:2:2"}), check)
    with pytest.raises(InputError, match="low = -1"):
        refuse_bad_values(variations_of({"low": "-1:1", "high": "1:2"}), check)


def test_shares_of_the_variance_of_a_grid_are_exact():
    # y = 2 a + b + a b over a, b = -1, 1: variances 4, 1 and 1 of 6.
    design = grid_design(variations_of({"a": "-1:1:2", "b": "-1:1:2"}))
    result = np.array([2 * a + b + a * b for a, b in design.rows], dtype=float)
    found = indices(design, result)
    assert found.first == pytest.approx([4 / 6, 1 / 6])
    assert found.total == pytest.approx([5 / 6, 2 / 6])
    assert indices(design, np.where(result > 0.0, np.nan, result)) is None
    assert indices(design, np.ones(4)) is None


def test_sobol_indices_hold_those_of_a_function_that_knows_them():
    # y = 2 a + b c over 0 to 1: variances of a, b, c and of b and c together: 1/3, 1/48, 1/48, 1/144.
    design = sobol_design(variations_of({"a": "0:1", "b": "0:1", "c": "0:1"}), 256, seed=1)
    result = np.array([2 * a + b * c for a, b, c in design.rows])
    whole = 1 / 3 + 2 / 48 + 1 / 144
    found = indices(design, result)
    first, total = np.array([1 / 3, 1 / 48, 1 / 48]) / whole, np.array([1 / 3, 4 / 144, 4 / 144]) / whole
    assert np.all(abs(found.first - first) < 1.5 * found.first_interval)
    assert np.all(abs(found.total - total) < 1.5 * found.total_interval)
    assert max(found.first_interval.max(), found.total_interval.max()) < 0.2
    assert found.runs == len(design.rows) == 256 * 5
    np.testing.assert_array_equal(indices(design, result).total_interval, found.total_interval)
    assert sobol_design(variations_of({"a": "0:1"}), 4, seed=0) == sobol_design(variations_of({"a": "0:1"}), 4, seed=0)
    # Base samples with a failed run are left out.
    result[7] = np.nan
    assert indices(design, result).runs == 255 * 5
    result[5:] = np.nan
    assert indices(design, result) is None


def test_means_and_ranks_leave_failed_runs_out():
    effect = main_effect([1, 2, 1, 2], np.array([1.0, 4.0, 3.0, np.nan]))
    assert effect.values == (1, 2)
    assert effect.mean == pytest.approx([2.0, 4.0])
    assert rank_correlation([1, 2, 3, 4], np.array([1.0, np.nan, 9.0, 8.0])) == pytest.approx(0.5)
    assert np.isnan(rank_correlation(["x", "y", "z"], np.array([1.0, 2.0, 3.0])))


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    """Four runs of which one fails, by the command in this process and one worker."""
    folder = tmp_path_factory.mktemp("sweep")
    scene = write_scene(folder / "falling.toml", FALLING)
    # The larger step is above the stable one of the lighter block.
    arguments = ("sweep", scene, "--vary", "body.0.density=500:1000:2", "--vary", "time.step=[1e-3, 1.7e-2]")
    done = grainlaw(*arguments, "--out", folder / "out", "--workers", "1")
    return folder / "out", done, arguments


def test_a_sweep_ends_well_with_failures_told_and_counted(swept):
    folder, done, _ = swept
    assert done.returncode == 0
    first, reason, *files = done.stdout.splitlines()
    assert first == "4 runs: 3 finished, 1 failed"
    assert reason.startswith("  01: ")
    assert "time.step = 0.017 s is above the stable step" in reason
    assert [line.strip() for line in files] == [str(folder / f"sweep.{kind}") for kind in ("csv", "parquet", "html")]
    assert done.stderr.splitlines()[-1].endswith("(4 of 4 runs, 1 failed)")


def test_the_tables_have_a_row_for_each_run(swept):
    folder, _, _ = swept
    table = pyarrow.parquet.read_table(folder / "sweep.parquet")
    assert table["run"].to_pylist() == ["00", "01", "02", "03"]
    assert table["body.0.density"].to_pylist() == [500, 500, 1000, 1000]
    assert table["time.step"].to_pylist() == [1e-3, 1.7e-2, 1e-3, 1.7e-2]
    assert table["verdict"].to_pylist() == ["finished", "failed", "finished", "finished"]
    assert [bool(reason) for reason in table["reason"].to_pylist()] == [False, True, False, False]
    final = read_summary(folder / "02").final
    assert table["runout"].to_pylist()[1:3] == [None, final.runout]
    assert table["kinetic_energy"].to_pylist()[2] == final.kinetic_energy
    assert table.schema.field("kinetic_energy").metadata == {b"unit": b"J/m"}
    with (folder / "sweep.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["runout [m]"] for row in rows][1] == ""
    assert float(rows[2]["kinetic_energy [J/m]"]) == final.kinetic_energy


def test_the_page_needs_no_other_file_and_tells_failures(swept):
    page = (swept[0] / "sweep.html").read_text()
    assert "4 runs, 3 finished, 1 failed" in page
    assert "above the stable step" in page
    assert page.count("data:image/png") == 1
    assert "http" not in page.replace("http-equiv", "")


def test_a_sweep_that_goes_on_repeats_nothing_finished(swept, monkeypatch):
    folder, _, arguments = swept
    table, left = (folder / "sweep.csv").read_text(), []

    def failing(client, members, out):
        left.extend(members)
        return iter([Outcome(member.name, out / member.name, "again") for member in members])

    monkeypatch.setattr("grainlaw.studies.batch.workers_of", lambda scheduler, workers: nullcontext())
    monkeypatch.setattr("grainlaw.studies.batch._outcomes", failing)
    done = grainlaw(*arguments, "--out", folder, "--resume")
    assert [member.name for member in left] == ["01"]
    assert done.returncode == 0
    assert "  01: again" in done.stdout.splitlines()
    assert (folder / "sweep.csv").read_text().splitlines()[3:] == table.splitlines()[3:]
    found = gl.sweep(FALLING, folder, {"body.0.density": "500:1000:2", "time.step": [1e-3, 1.7e-2]}, resume=True)
    assert [outcome.reason for outcome in found.failed] == ["again"]
    frame = found.to_frame()
    assert list(frame["body.0.density"]) == [500, 500, 1000, 1000]
    assert frame.attrs["units"]["height"] == "m"
    assert (folder / "sweep.csv").read_text().splitlines()[3:] == table.splitlines()[3:]


def test_a_folder_with_other_runs_is_refused(swept):
    folder, _, arguments = swept
    assert "00 already holds a run; choose another --out" in grainlaw(*arguments, "--out", folder).stderr
    with pytest.raises(InputError, match=r"00 holds a run of another scene.*body.0.density = 500.0 there, 700.0 here"):
        gl.sweep(FALLING, folder, {"body.0.density": [700, 800], "time.step": [1e-3]}, resume=True)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--vary", "grid.cel_size=0.1:0.2:2"], "unknown key 'grid.cel_size'; did you mean 'cell_size'?"),
        (["--vary", "material.linear_elastic.poisson_ratio=0.2:0.7:2"], "poisson_ratio = 0.7"),
        (["--vary", "body.3.density=1:2:2"], "--vary body.3.density: '3' is no entry of the list; allowed: 0 to 0"),
        (["--vary", "body.0.density=2:1:2"], "the range is empty"),
        (["--vary", "body.0.density"], "--vary body.0.density: expected name=value"),
        (["--vary", "body.0.density=-5:5", "--samples", "4"], "body.0.density = -5.0: allowed: > 0"),
        (["--vary", "time.end=1:2:2", "--set", "time.end=3"], "time.end is both set and varied"),
        ([], "nothing is varied"),
        (["--vary", "time.end=1:2", "--sobol"], "--sobol takes --samples N"),
        (["--vary", "time.end=1:2", "--from", "p.toml", "--samples", "2"], "neither --vary nor --sobol"),
        (["--from", "missing.toml", "--samples", "2"], "missing.toml"),
        (["--vary", "time.end=1:2:2", "--workers", "2", "--scheduler", "tcp://1:2"], "workers = 2: the scheduler"),
    ],
)
def test_a_bad_request_is_one_line_before_anything_is_run(tmp_path, arguments, message):
    scene = write_scene(tmp_path / "scene.toml", FALLING)
    done = grainlaw("sweep", scene, "--out", tmp_path / "out", *arguments)
    assert done.returncode == 2
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not list(tmp_path.glob("out/*"))
