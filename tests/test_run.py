"""A run from Python: its folder, its energies, and what it says when the computation goes wrong."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from scenes_for_tests import (
    BLOCK,
    COLUMN,
    FALLING_SPRING,
    call_command_line,
    changed,
    fresh_registry,
    simulation,
    write_plugin,
    write_scene,
)

from grainlaw.materials import InputError, SimulationError
from grainlaw.mpm_core import Scene, run
from grainlaw.mpm_core.output.frame_series import read_collection
from grainlaw.mpm_core.output.history import history_columns, read_history
from grainlaw.mpm_core.output.run_folder import RunFolder

__all__ = ["fresh_registry"]

SUMMARY_KEYS = [
    "scene", "material", "points", "cells", "steps", "simulated_time", "mass_left", "points_left", "mass_in",
    "points_in", "wall_time", "compile_time", "point_steps_per_second", "peak_memory_bytes", "final",
    "energy_balance_error", "limited", "threads", "version",
]  # fmt: skip
FINAL_KEYS = ["runout", "height", "center_of_mass_height", "kinetic_energy"]


def scene(content, **changes):
    return Scene.from_dict(changed(content, changes))


@pytest.fixture(scope="module")
def column_run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "column"
    return run(scene(COLUMN), folder), RunFolder(folder)


def test_the_folder_holds_a_frame_for_each_interval_and_the_end(column_run):
    _, folder = column_run
    names = sorted(path.name for path in folder.path.iterdir())
    frames = [f"points_{number:06d}.vtu" for number in range(7)]
    assert names == sorted([*frames, "run.pvd", "history.csv", "quantities.csv", "scene.toml", "summary.json",
                            "checkpoint.h5"])  # fmt: skip
    np.testing.assert_allclose(folder.frame_times, 0.05 * np.arange(7), atol=1e-15)
    assert [file.path.name for file in folder.frame_files] == frames


def test_frames_hold_the_points_in_the_order_of_generation(column_run):
    _, folder = column_run
    first, last = folder.load_frame(0), folder.load_frame(-1)
    start = simulation(COLUMN).bodies[0].points[:2].T
    np.testing.assert_array_equal(first.positions[:, :2], start)
    moved = last.positions[:, :2] - start
    assert np.abs(moved).max() < 0.5
    assert moved[:, 1].min() < -0.05
    assert all(np.isfinite(field.values).all() for field in last.fields)
    assert {"velocity", "pressure", "deviatoric_stress", "shear_strain", "solid_fraction"} == {
        field.name for field in last.fields
    }


def test_the_summary_has_the_agreed_keys_and_agrees_with_the_run(column_run):
    returned, folder = column_run
    summary = json.loads((folder.path / "summary.json").read_text())
    assert list(summary) == SUMMARY_KEYS
    assert list(summary["final"]) == FINAL_KEYS
    assert summary == returned.model_dump()
    assert (summary["scene"], summary["material"], summary["threads"]) == ("column", "mu_i_lc", 1)
    assert (summary["points"], summary["cells"]) == (12 * 32 * 4, 128 * 40)
    assert summary["simulated_time"] == 0.3
    last = folder.history[-1]
    assert summary["final"] == {key: last[key] for key in FINAL_KEYS}
    assert summary["steps"] == last["step"]


def test_the_history_goes_from_the_start_to_the_end_without_a_step_twice(column_run):
    _, folder = column_run
    history = folder.history
    assert history.dtype.names == tuple(column.name for column in history_columns())
    assert (history["t"][0], history["t"][-1], history["step"][0]) == (0.0, 0.3, 0)
    assert (np.diff(history["step"]) > 0).all()
    assert (np.diff(history["t"]) > 0).all()
    assert history["runout"][-1] > history["runout"][0]
    assert history["center_of_mass_height"][-1] < history["center_of_mass_height"][0]


def test_the_ledger_balances_and_the_numerics_take_a_small_part(column_run):
    summary, folder = column_run
    last = folder.history[-1]
    released = -last["potential_energy"]
    spent = sum(last[name] for name in ("kinetic_energy", "internal_work", "wall_work", "numerical_dissipation"))
    assert spent == pytest.approx(released + last["volume_projection"], rel=1e-9)
    assert summary.energy_balance_error < 0.2
    fallen = 1500.0 * 0.3 * 0.8 * 9.8 * (folder.history["center_of_mass_height"][0] - last["center_of_mass_height"])
    assert released == pytest.approx(fallen, rel=1e-3)


def ringing_bar(safety, time_constant):
    """Kinetic energies over time of a bar that is stretched by its first mode, and its numerical dissipation, both
    relative to the energy at the start.
    """
    bar = {"kind": "rectangle", "lower": [0.0, 0.2], "upper": [0.6, 0.4]}
    case = simulation(BLOCK, {"body.0.shape": bar, "transfer.time_constant": time_constant})
    (body,) = case.bodies
    phase = 0.5 * np.pi * body.positions[0] / 0.6
    body.velocity[0] = 0.05 * np.sin(phase)
    body.velocity_gradient[0, 0] = body.affine[0, 0] = 0.05 * 0.5 * np.pi / 0.6 * np.cos(phase)
    squares = (body.velocity**2).sum() + 0.25 * case.grid.cell_size**2 * (body.affine**2).sum()
    start = case.ledger.initial_kinetic = 0.5 * body.point_mass * float(squares)
    kinetic = []
    while case.time < 0.6:
        case.step(safety * case.critical_time_step())
        kinetic.append(case.ledger.kinetic / start)
    return np.array(kinetic), case.ledger.numerical_dissipation / start


@pytest.mark.parametrize("time_constant", [0.01, 10.0])
def test_an_elastic_bar_rings_and_keeps_its_energy(time_constant):
    kinetic, loss = ringing_bar(0.1, time_constant)
    turn = int(np.argmin(kinetic[: len(kinetic) // 2]))
    assert kinetic[turn] < 0.01
    assert kinetic[turn:].max() > 0.95
    assert abs(loss) < 0.02


def test_the_energy_error_of_an_elastic_bar_is_small_with_any_step():
    errors = {safety: abs(ringing_bar(safety, 10.0)[1]) for safety in (0.8, 0.3, 0.05)}
    assert errors[0.8] < 1e-2
    assert errors[0.3] < 4e-3
    assert errors[0.05] < errors[0.3]


@pytest.mark.parametrize(("end", "interval"), [(0.95, None), (0.9, 0.3), (0.1, 0.03), (0.1, 1.0)])
def test_no_frame_is_written_twice_at_the_end(tmp_path, end, interval):
    changes = {"time.end": end, "output": {"pictures": False, "fields": ["velocity"]}}
    if interval is not None:
        changes["output"]["interval"] = interval
    run(scene(BLOCK, **changes), tmp_path)
    times = [file.time for file in read_collection(tmp_path)]
    expected = np.arange(0.0, end, interval or end / 30)
    expected = [*expected[expected < end * (1 - 1e-9)], end]
    np.testing.assert_allclose(times, expected, rtol=1e-12)


def test_pictures_are_drawn_without_the_field_that_they_usually_show(tmp_path):
    run(scene(BLOCK, **{"output": {"fields": ["velocity"], "interval": 0.1}}), tmp_path)
    assert sorted(path.name for path in tmp_path.glob("*.png")) == ["final.png", "history.png"]


def test_a_folder_that_holds_a_run_is_not_touched_without_overwrite(tmp_path):
    small = scene(BLOCK, **{"output.pictures": False, "time.end": 0.02})
    run(small, tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(InputError, match="already holds a run"):
        run(small, tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
    run(scene(BLOCK, **{"output": {"pictures": False, "vtu": False}, "time.end": 0.01}), tmp_path, overwrite=True)
    assert not list(tmp_path.glob("*.vtu"))
    assert read_history(tmp_path)["t"][-1] == 0.01
    assert (tmp_path / "notes.txt").read_text() == "mine"


def fails(monkeypatch, capsys, tmp_path, content, changes, **plugin):
    """The one line of a run that goes wrong, and its folder."""
    path = write_scene(tmp_path / "scene.toml", content, changes)
    law = write_plugin(tmp_path / f"{tmp_path.name}.py", **plugin)
    out = tmp_path / "out"
    assert call_command_line(monkeypatch, "run", path, "--plugin", law, "--out", out) == 1
    # A slow machine prints lines of progress before.
    error = capsys.readouterr().err.splitlines()[-1]
    assert error.startswith("error: ")
    assert not (out / "summary.json").exists()
    checkpoint = Path(re.search(r"last checkpoint: (.*)$", error.strip())[1])
    assert checkpoint == out / "checkpoint.h5"
    assert checkpoint.is_file()
    return error, out


def test_a_law_that_gives_nan_stops_the_run_with_time_step_point_and_place(
    tmp_path, monkeypatch, capsys, fresh_registry
):
    update = "new = (math.nan if trace(new) < -300.0 else 1.0) * new"
    error, out = fails(monkeypatch, capsys, tmp_path, FALLING_SPRING, {"output.interval": 0.01}, update=update)
    found = re.search(r"t = (\S+) s, step (\d+): point (\d+) of body\.0 \(spring\) at \((\S+), (\S+)\) m", error)
    time, step, point, x, y = (float(group) for group in found.groups())
    assert 0.0 < time < 0.5
    assert step > 0
    assert 0 <= point < 64
    assert 0.3 < x < 0.7
    assert 0.0 < y < 0.5
    assert "finite" in error
    history = read_history(out)
    # The spring of these tests states no elastic energy.
    undefined = {"elastic_energy", "inelastic_work"}
    assert all(np.isfinite(history[name]).all() for name in history.dtype.names if name not in undefined)
    assert 0.0 < read_collection(out)[-1].time < time


def test_a_step_that_becomes_unstable_stops_the_run(tmp_path, monkeypatch, capsys, fresh_registry):
    faster = "if trace(stress) < -600.0:\n        return 1e3"
    changes = {"time.step": 2e-3}
    error, _ = fails(monkeypatch, capsys, tmp_path, FALLING_SPRING, changes, sound_speed=faster)
    assert re.search(r"t = \S+ s, step \d+: the fixed step 0\.002 s is above the stable one, now \S+e-05 s", error)


def test_a_stable_step_that_vanishes_stops_the_run(tmp_path, monkeypatch, capsys, fresh_registry):
    faster = "if trace(stress) < -600.0:\n        return 1e12"
    error, _ = fails(monkeypatch, capsys, tmp_path, FALLING_SPRING, {}, sound_speed=faster)
    asked = r"the step would have to shrink to \S+ s, below the smallest one, \S+ s \(time\.smallest_step\)"
    assert re.search(rf"point \d+ of \S+ \(\S+\) at .* m: {asked}: sound speed 1e\+12 m/s", error)
    assert "last checkpoint: " in error


def test_a_point_that_leaves_through_a_removed_wall_stops_the_run():
    case = simulation(BLOCK, {"body.0.velocity": [0.0, -5.0]})
    case.walls.clear()

    def fall():
        while case.time < 1.0:
            case.step(1e-3)

    with pytest.raises(SimulationError, match=r"step \d+: point \d+ of body\.0 .* the point has left the domain"):
        fall()
    assert case.bodies[0].positions[1].min() < 0.0


def test_python_runs_a_scene_and_reports_each_step(tmp_path):
    seen = []
    small = scene(BLOCK, **{"output": {"pictures": False, "vtu": False}})
    summary = run(small, tmp_path, progress=lambda simulation, dt: seen.append((simulation.time, dt)))
    assert len(seen) == summary.steps
    assert seen[-1][0] == summary.simulated_time == 0.1
    assert sum(dt for _, dt in seen) == pytest.approx(0.1)
