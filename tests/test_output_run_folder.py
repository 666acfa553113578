"""History, summary and the run's folder as a reader opens it."""

import json

import numpy as np
import pytest
from pydantic import ValidationError
from synthetic_run import FRAMES, frame, history_row, write_run

from grainlaw.materials import InputError
from grainlaw.mpm_core.output.history import HistoryWriter, history_columns, read_history
from grainlaw.mpm_core.output.rows import keep_rows
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.mpm_core.output.summary import RunSummary, read_summary, write_summary

SUMMARY = {
    "scene": "collapse",
    "material": "mu_i_lc",
    "points": 27648,
    "cells": 131072,
    "steps": 1000,
    "simulated_time": 1.5,
    "mass_left": 0.0,
    "points_left": 0,
    "mass_in": 0.0,
    "points_in": 0,
    "wall_time": 12.5,
    "compile_time": 3.0,
    "point_steps_per_second": 2.0e7,
    "peak_memory_bytes": 2**28,
    "final": {"runout": 0.66, "height": 0.32, "center_of_mass_height": 0.12, "kinetic_energy": 1e-6},
    "energy_balance_error": 1e-3,
    "limited": {"points_without_stress": 12, "points_at_a_wall": 0, "points_at_a_bound_of_their_law": 0},
    "threads": 2,
    "version": "0.1.0",
}


def write_history(folder, steps):
    writer = HistoryWriter(folder)
    for step in steps:
        writer.append(history_row(step))
    writer.close()


def test_history_reads_back_exactly_and_by_column(tmp_path):
    write_history(tmp_path, range(4))
    history = read_history(tmp_path)
    assert history.dtype.names == tuple(column.name for column in history_columns())
    assert history["step"].dtype.kind == "i"
    for number in range(4):
        assert dict(zip(history.dtype.names, history[number].tolist(), strict=True)) == history_row(number)


def test_each_row_is_on_file_while_the_run_goes_on(tmp_path):
    writer = HistoryWriter(tmp_path)
    assert len(read_history(tmp_path)) == 0
    writer.append(history_row(0))
    assert len(read_history(tmp_path)) == 1
    writer.close()


def test_a_row_cut_off_by_a_crash_is_left_out_and_dropped_on_resume(tmp_path):
    write_history(tmp_path, range(10))
    with (tmp_path / "history.csv").open("a") as file:
        file.write("0.01,0.0")
    assert len(read_history(tmp_path)) == 10
    keep_rows(tmp_path / "history.csv", 7)
    write_history(tmp_path, [7])
    assert read_history(tmp_path)["step"].tolist() == list(range(8))


def test_a_row_with_other_columns_is_refused(tmp_path):
    row = history_row(0) | {"temperature": 1.0}
    del row["height"]
    with pytest.raises(ValueError, match=r"\['height', 'temperature'\]"):
        HistoryWriter(tmp_path).append(row)


def test_summary_reads_back_with_the_declared_keys_in_order(tmp_path):
    write_summary(tmp_path, RunSummary.model_validate(SUMMARY))
    assert json.loads((tmp_path / "summary.json").read_text()) == SUMMARY
    assert list(json.loads((tmp_path / "summary.json").read_text())) == list(SUMMARY)
    assert read_summary(tmp_path).final.runout == 0.66


def test_a_summary_never_holds_nan():
    with pytest.raises(ValidationError, match="energy_balance_error"):
        RunSummary.model_validate(SUMMARY | {"energy_balance_error": float("nan")})


def test_a_run_folder_gives_frames_with_units_history_and_times(tmp_path):
    run = RunFolder(write_run(tmp_path / "run"))
    assert run.frame_times.tolist() == [frame(number).time for number in range(FRAMES)]
    last = run.load_frame(-1)
    np.testing.assert_array_equal(last.positions, frame(FRAMES - 1).positions)
    assert (last.field("pressure").unit, last.field("velocity").values.shape[1]) == ("Pa", 3)
    assert last.field("pressure").doc == frame(0).field("pressure").doc
    assert run.history["runout"][-1] == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("break_it", "read", "message"),
    [
        (lambda f: (f / "run.pvd").unlink(), lambda r: r.frame_files, "holds no run.pvd"),
        (lambda f: (f / "run.pvd").write_text("<VTKFile>"), lambda r: r.frame_files, "cannot be read as a ParaView"),
        (lambda f: (f / "points_000002.vtu").unlink(), lambda r: r.load_frame(2), "points_000002.vtu is missing"),
        (lambda f: None, lambda r: r.load_frame(FRAMES), "no frame 11 .* allowed are 0 to 10"),
        (lambda f: None, lambda r: r.load_frame(0).field("presure"), "did you mean 'pressure'"),
        (lambda f: (f / "history.csv").unlink(), lambda r: r.history, "holds no history.csv"),
        (lambda f: (f / "history.csv").write_text("t,dt\n1,x\n"), lambda r: r.history, "history.csv cannot be read"),
        (lambda f: (f / "history.csv").write_text("t,dt\n"), lambda r: r.history, "holds no row yet"),
        (lambda f: None, lambda r: r.summary, "the run has not finished"),
        (lambda f: (f / "summary.json").write_text("{"), lambda r: r.summary, "summary.json cannot be read"),
        (lambda f: (f / "summary.json").write_text("{}"), lambda r: r.summary, "'scene' is missing"),
    ],
)
def test_what_is_missing_or_broken_is_said_in_one_line(tmp_path, break_it, read, message):
    folder = write_run(tmp_path / "run")
    break_it(folder)
    with pytest.raises(InputError, match=message) as caught:
        read(RunFolder(folder))
    assert "\n" not in str(caught.value)


def test_a_folder_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        RunFolder(tmp_path / "nowhere")
