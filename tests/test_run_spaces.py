"""Whole runs in axisymmetry and in 3D: files, going on after a stop, threads, precision, sleep, and the commands.

All are of one tiny scene per space, so that kernels are compiled once.
"""

import tomllib

import h5py
import numpy as np
import pytest
from scenes_for_tests import MU_I_LC, Finished, changed, grainlaw, write_scene
from test_resume import StoppedError, assert_same_runs, kill_in_the_middle, start, stopped_at

from grainlaw.mpm_core import Scene, run
from grainlaw.mpm_core.output.run_folder import RunFolder

STRESSES = [f"stress_{name}" for name in ("xx", "yy", "zz", "xy", "yz", "xz")]
COMMON = {
    "grid": {"cell_size": 0.05},
    "time": {"end": 0.12},
    "boundary": {"bottom": {"kind": "friction", "coefficient": 0.5}},
    "material": {"mu_i_lc": MU_I_LC},
    "output": {"interval": 0.03, "history_interval": 0.01, "pictures": False, "vtkhdf": True},
}
BODY = {"material": "mu_i_lc", "density": 1500.0, "initial_stress": {"kind": "geostatic"}}
QUARTER = COMMON | {
    "space": "3d",
    "grid": {"cell_size": 0.05, "upper": [0.6, 0.5, 0.4]},
    "body": [BODY | {"shape": {"kind": "box", "lower": [0.0, 0.0, 0.0], "upper": [0.2, 0.2, 0.3]}}],
    "output": COMMON["output"] | {"fields": ["velocity", "shear_strain", "density", *STRESSES]},
}
CYLINDER = COMMON | {
    "space": "axisymmetric",
    "grid": {"cell_size": 0.05, "upper": [0.6, 0.4]},
    "body": [BODY | {"shape": {"kind": "rectangle", "lower": [0.0, 0.0], "upper": [0.2, 0.3]}}],
}
SPACES = {"axisymmetric": CYLINDER, "3d": QUARTER}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A finished run in each space."""
    folder = tmp_path_factory.mktemp("runs")
    for name, content in SPACES.items():
        run(Scene.from_dict(content), folder / name)
    return folder


def test_frames_in_3d_hold_places_and_six_stresses(runs):
    folder = RunFolder(runs / "3d")
    frame = folder.load_frame(0)
    places = frame.positions
    assert places.min(axis=0) == pytest.approx([0.0125] * 3)
    assert places.max(axis=0) == pytest.approx([0.1875, 0.1875, 0.2875])
    vertical = -9.81 * 1500.0 * (0.3 - places[:, 2])
    for name in ("stress_xx", "stress_yy", "stress_zz"):
        np.testing.assert_allclose(frame.field(name).values, vertical, rtol=0.02, atol=40.0)
    late = folder.load_frame(-1)
    # What shears across the plane of symmetry of a square is the same along x and along y.
    assert np.abs(late.field("stress_xz").values).max() > 50.0
    for along_x, along_y in (("stress_xx", "stress_yy"), ("stress_xz", "stress_yz")):
        first, second = np.sort(late.field(along_x).values), np.sort(late.field(along_y).values)
        np.testing.assert_allclose(first, second, atol=0.02 * np.abs(first).max())
    with h5py.File(runs / "3d" / "run.vtkhdf") as file:
        root, count = file["VTKHDF"], len(places)
        np.testing.assert_array_equal(root["Points"][-count:], late.positions)
        for name in STRESSES:
            np.testing.assert_array_equal(root["PointData"][name][-count:], late.field(name).stored_values())


def test_masses_and_energies_are_those_of_the_part_that_the_space_has(runs):
    weight = 9.81 * 1500.0 * 0.3
    for name, base in (("axisymmetric", 0.5 * 0.2**2), ("3d", 0.2**2)):
        history = RunFolder(runs / name).history
        fallen = history["center_of_mass_height"][0] - history["center_of_mass_height"]
        np.testing.assert_allclose(
            history["potential_energy"][1:-1], -weight * base * fallen[1:-1], rtol=0.1, atol=1e-3
        )
        assert fallen[-1] > 0.02


def test_summaries_count_all_cells(runs):
    assert RunFolder(runs / "3d").summary.cells == 12 * 10 * 8


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("where", ["write_checkpoint", "append_frame"])
def test_a_run_that_was_stopped_goes_on_to_the_same_bits_with_two_threads(tmp_path, monkeypatch, runs, space, where):
    scene = Scene.from_dict(SPACES[space])
    with monkeypatch.context() as patch:
        stopped_at(patch, where, call=4)
        with pytest.raises(StoppedError):
            run(scene, tmp_path, threads=2)
    run(scene, tmp_path, threads=2, resume=True)
    assert_same_runs(runs / space, tmp_path)


def test_a_killed_run_in_3d_goes_on_to_the_same_bits(tmp_path):
    changes = {"grid.cell_size": 0.025, "time.end": 0.4, "output.history_interval": 0.005}
    scene_file = write_scene(tmp_path / "scene.toml", changed(QUARTER, changes))
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    run(Scene.load(scene_file), whole)
    kill_in_the_middle(start(scene_file, killed), killed, after=0.1)
    assert 0.1 < RunFolder(killed).history["t"][-1] < 0.4
    run(Scene.load(scene_file), killed, resume=True)
    assert_same_runs(whole, killed)


def test_a_run_in_3d_in_single_precision_is_that_in_double(tmp_path, runs):
    run(Scene.from_dict(QUARTER | {"precision": "single"}), tmp_path)
    with h5py.File(tmp_path / "checkpoint.h5") as file:
        assert file["body/0/points"].dtype == np.float32
    single, double = (RunFolder(folder).load_frame(-1) for folder in (tmp_path, runs / "3d"))
    np.testing.assert_allclose(single.positions, double.positions, atol=1e-3)
    assert not np.array_equal(single.positions, double.positions)


@pytest.mark.parametrize("space", SPACES)
def test_a_pile_that_fell_asleep_goes_on_to_the_same_bits(tmp_path, monkeypatch, space):
    changes = {"sleep": {"speed": 0.1, "window": 0.03}, "time.end": 0.75, "output.interval": 0.15}
    scene = Scene.from_dict(changed(SPACES[space], {**changes, "output.history_interval": 0.05}))
    whole, stopped = tmp_path / "whole", tmp_path / "stopped"
    run(scene, whole)
    history = RunFolder(whole).history
    assert history["points_asleep"][history["t"] < 0.1].max() == 0
    assert history["points_asleep"][-3:].min() > 0.5 * RunFolder(whole).summary.points
    with monkeypatch.context() as patch:
        stopped_at(patch, "append_frame", call=6)
        with pytest.raises(StoppedError):
            run(scene, stopped)
    run(scene, stopped, resume=True)
    assert_same_runs(whole, stopped)


def command(*arguments) -> Finished:
    done = grainlaw(*arguments)
    assert done.returncode == 0, done.stderr
    return done


def test_compare_and_report_say_what_energies_are_per(tmp_path, runs):
    folders = [runs / name for name in SPACES]
    printed = command("compare", *folders, "--out", tmp_path / "both").stdout
    for heading in ("runout [m]", "height [m]"):
        assert heading in printed
    assert [line.split("│")[7].split()[1] for line in printed.splitlines() if "mu_i_lc" in line] == ["J/rad", "J"]
    assert (tmp_path / "both" / "snapshots.png").exists()
    command("report", folders[0], "--out", tmp_path / "report")
    assert "J/rad" in (tmp_path / "report" / "report.md").read_text()


@pytest.mark.parametrize("space", SPACES)
def test_plan_counts_what_a_run_takes(tmp_path, runs, space):
    printed = command("plan", write_scene(tmp_path / "scene.toml", SPACES[space]), "--threads", 1).stdout
    summary = RunFolder(runs / space).summary
    assert f"{summary.points:,}" in printed
    assert f"{summary.cells:,}" in printed
    steps = int(printed.split("about ")[1].split()[0].replace(",", ""))
    assert steps == pytest.approx(summary.steps, rel=0.3)


def test_a_run_says_what_its_energy_is_per(tmp_path):
    scene_file = write_scene(tmp_path / "scene.toml", CYLINDER)
    assert " J/rad\n" in command("run", scene_file, "--out", tmp_path / "run", "--threads", 1).stdout


def test_accuracy_is_refused_where_it_was_not_measured(tmp_path):
    for content in SPACES.values():
        done = grainlaw("plan", write_scene(tmp_path / "scene.toml", content | {"accuracy": "3%"}))
        assert done.returncode == 2
        assert len(done.stderr.splitlines()) == 1
        assert "accuracy = '3%' was measured in plane strain, in no other space" in done.stderr


def test_a_scene_of_a_run_holds_its_space(runs):
    for name in SPACES:
        assert tomllib.loads((runs / name / "scene.toml").read_text())["space"] == name
        assert RunFolder(runs / name).space.name == name
