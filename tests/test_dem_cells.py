"""Cells of grains: decks of the kinds of cells, and what their reduction makes of output with a known answer."""

import csv
import json

import numpy as np
import pytest

from grainlaw.validation.dem import shear_steps, triaxial, wall_shear
from grainlaw.validation.dem.batch import case_named
from grainlaw.validation.dem.description import ShearStage, ShearStep
from grainlaw.validation.dem.reduction import reduce_runs

BIN, TOP = 0.0075, 0.2
REVERSAL = case_named("shear-reversal").model_copy(
    update={
        "steps": (
            ShearStep(nominal_inertial_number=0.1, strain=0.4, block_strain=0.2),
            ShearStep(nominal_inertial_number=-0.05, strain=0.2, block_strain=0.1),
        )
    }
)
WALL = case_named("wall-shear").model_copy(
    update={"stages": (ShearStage(nominal_inertial_number=0.1, transient_strain=1.0, average_strain=1.0),)}
)


def profile(case, rate: float, slip: float, drag: float, normal: float, blocks: int) -> str:
    """Blocks of `fix ave/spatial`: simple shear above a slip, uniform stress and a solid fraction of 0.5."""
    heights = np.arange(BIN / 2, TOP, BIN)
    count = 10.0
    per_volume = count / (case.length * case.depth * BIN)
    stress = [-normal / per_volume, -0.5 * normal / per_volume, -normal / per_volume, -drag / per_volume]
    # LIGGGHTS' sign: a drag along x is a negative stress here, as in its own output.
    stress[3] *= -1.0
    density = 0.5 * case.grains.density
    mass = density / per_volume
    lines = []
    for step in range(1, blocks + 1):
        lines.append(f"{step * 100} {len(heights)}")
        for index, z in enumerate(heights):
            vx = slip + rate * z
            row = [index + 1, z, count, vx, 0.0, density, *stress, mass * vx * vx, 0.0, 0.0, 0.0]
            lines.append(" ".join(f"{value:.9g}" for value in row))
    return "\n".join(lines) + "\n"


def heights(blocks: int) -> str:
    return "".join(f"{step * 100} {TOP}\n" for step in range(1, blocks + 1))


def rows(folder, name: str) -> list[dict[str, float]]:
    with (folder / name).open() as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def test_strain_and_friction_follow_the_sense_of_shear(tmp_path):
    for stage, (rate, drag) in enumerate([(10.0, 2000.0), (-5.0, -1500.0)]):
        (tmp_path / f"profile_{stage}.txt").write_text(profile(REVERSAL, rate, 0.0, drag, 5000.0, 2))
        (tmp_path / f"height_{stage}.txt").write_text(heights(2))
    found = shear_steps.reduce(REVERSAL, tmp_path)
    table = rows(tmp_path, found.table)
    # Both stages make blocks of 0.2/(0.1 u) = 0.1/(0.05 u) seconds, u the rate at I = 1.
    block = table[0]["time"] * 2.0
    assert [row["stage"] for row in table] == [0, 0, 1, 1]
    assert [row["time"] / block for row in table] == pytest.approx([0.5, 1.5, 2.5, 3.5])
    assert [row["strain"] / block for row in table] == pytest.approx([5.0, 15.0, 17.5, 12.5])
    assert [row["shear_stress"] for row in table] == pytest.approx([2000.0, 2000.0, -1500.0, -1500.0])
    assert table[0]["inertial_number"] == pytest.approx(10.0 * 0.015 / np.sqrt(5000.0 / 2450.0))
    assert table[2]["inertial_number"] == pytest.approx(0.5 * table[0]["inertial_number"])
    assert {row["solid_fraction"] for row in table} == {0.5}
    assert found.steps == 400


def test_slip_and_friction_of_a_plane(tmp_path):
    (tmp_path / "profile_0.txt").write_text(profile(WALL, 4.0, 0.3, 1750.0, 5000.0, 3))
    (tmp_path / "height_0.txt").write_text(heights(3))
    (row,) = rows(tmp_path, wall_shear.reduce(WALL, tmp_path).table)
    # Next to the plane: the mean of the two lowest bins.
    assert row["slip_velocity"] == pytest.approx(0.3 + 4.0 * BIN)
    assert row["slip_number"] == pytest.approx(row["slip_velocity"] / np.sqrt(5000.0 / 2450.0), rel=1e-5)
    assert row["friction"] == pytest.approx(0.35)
    assert row["top_velocity"] == pytest.approx(0.3 + 4.0 * 26.5 * BIN)


def test_a_plane_takes_the_place_of_the_lower_wall():
    flat, rough = wall_shear.files(WALL, 1), shear_steps.files(REVERSAL, 1)
    atoms = [int(files["grains.data"].split()[1]) for files in (flat, rough)]
    wall = sum(line.split()[1:2] == ["2"] for line in flat["grains.data"].splitlines())
    assert atoms[1] - atoms[0] == wall
    assert "zplane" in flat["deck.in"]
    assert "zplane" not in rough["deck.in"]


def test_strains_and_stresses_of_a_compressed_cube(tmp_path):
    case = case_named("triaxial")
    (tmp_path / "grains.data").write_text("grains\n\nAtoms\n\n1 1 0.02 2450 0 0 0\n")
    solid = np.pi / 6.0 * 0.02**3
    lines = ["0 1 2e-5 0.03 5000 5000 5000 0.1", "SHEARING", "0 1 2e-5 0.03 5000 5000 5000 0.1"]
    lines += [f"{50 * n} 1 1.6e-5 0.024 5000 5200 15000 0.1" for n in range(1, triaxial.AVERAGED * 2)]
    (tmp_path / "log.txt").write_text("\n".join([*lines, "FINISHED"]) + "\n")
    table = rows(tmp_path, triaxial.reduce(case, tmp_path).table)
    assert len(table) == 3
    assert table[0] == pytest.approx(
        {"axial_strain": 0.0, "solid_fraction": solid / 2e-5, "axial_stress": 5e3, "stress_xx": 5e3, "stress_yy": 5e3},
        rel=1e-5,
    )
    assert table[2]["axial_strain"] == pytest.approx(np.log(0.03 / 0.024), rel=1e-5)
    assert table[2]["solid_fraction"] == pytest.approx(solid / 1.6e-5, rel=1e-5)
    assert (table[2]["stress_yy"], table[2]["axial_stress"]) == (5200.0, 15000.0)


def test_each_cell_has_its_own_table_and_replaces_only_itself(tmp_path):
    """The table of a case that is not made anew stays as it is, and so does what it was made from."""
    for case, value in (("triaxial", 1.0), ("triaxial-loose", 2.0)):
        run = tmp_path / "runs" / case / "liggghts-seed1"
        run.mkdir(parents=True)
        record = {"case": case, "kind": "triaxial", "code": "liggghts", "seed": 1, "table": "triaxial.csv"}
        (run / "run.json").write_text(json.dumps(record))
        names = ",".join(triaxial.COLUMNS)
        (run / "triaxial.csv").write_text(f"{names}\n" + ",".join([str(value)] * len(triaxial.COLUMNS)) + "\n")
    reduce_runs(tmp_path / "runs", tmp_path / "reference")
    kept = (tmp_path / "reference" / "triaxial_loose.csv").read_text()
    (tmp_path / "runs" / "triaxial-loose" / "liggghts-seed1" / "run.json").unlink()
    reduce_runs(tmp_path / "runs", tmp_path / "reference")
    known = json.loads((tmp_path / "reference" / "provenance.json").read_text())
    assert set(known) == {"triaxial/liggghts-seed1", "triaxial-loose/liggghts-seed1"}
    assert (tmp_path / "reference" / "triaxial_loose.csv").read_text() == kept
    assert kept.splitlines() == ["code,seed,strain,phi,sa,sr", "liggghts,1,2.0,2.0,2.0,2.0"]
