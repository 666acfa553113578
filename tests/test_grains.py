"""Readers, coarse graining and distances against packings whose answer is known, and files that must be refused."""

import json
from pathlib import Path

import numpy as np
import pytest
from grains_for_tests import DENSITY, DEPTH, HALF_WIDTHS, HEIGHTS, RADIUS, SPACING, WRITERS, blocks, write_run

from grainlaw.materials import InputError
from grainlaw.validation.grains.coarse_graining import column_lattice, kernel_of
from grainlaw.validation.grains.distance import Verdict, compare, profile_distance, verdict
from grainlaw.validation.grains.observation import read_observation, write_observation
from grainlaw.validation.grains.observe import observe_folder
from grainlaw.validation.grains.reference_file import load_reference

SOLID_FRACTION = 4.0 / 3.0 * np.pi * RADIUS**3 / SPACING**3
SMALL_COLLAPSE = Path(__file__).parent / "small_collapse"


@pytest.mark.parametrize("form", WRITERS)
def test_every_format_gives_the_known_block(tmp_path, form):
    found = observe_folder(write_run(tmp_path / "run", form))
    assert found.times == pytest.approx([0.0, 0.1])
    assert found.description["bulk_solid_fraction"] == pytest.approx(SOLID_FRACTION, rel=2e-3)
    assert found.of("height") == pytest.approx(HEIGHTS, abs=1e-3)
    # The vertical front falls between two cells.
    assert found.of("runout") == pytest.approx(HALF_WIDTHS, abs=SPACING / 2)
    assert found.of("center_of_mass_height") == pytest.approx(np.array(HEIGHTS) / 2)
    rows = blocks()[1]
    kinetic = 0.5 * DENSITY * 4.0 / 3.0 * np.pi * RADIUS**3 / DEPTH * float((rows[:, 5:8] ** 2).sum())
    assert found.of("kinetic_energy")[1] == pytest.approx(kinetic, rel=1e-6)


def test_the_kernel_keeps_the_volume_at_the_floor_too():
    lattice = column_lattice(0.0, 0.5, 0.0, 0.6)
    rng = np.random.default_rng(1)
    positions = np.column_stack([rng.uniform(-0.2, 0.2, 500), np.zeros(500), rng.uniform(0.0, 0.3, 500)])
    volumes = rng.uniform(1e-7, 2e-7, 500)
    field = kernel_of(positions, lattice, 0.015, DEPTH).field(volumes)
    assert field.sum() * SPACING**2 * DEPTH == pytest.approx(volumes.sum(), rel=1e-4)


def test_an_observation_survives_its_file(tmp_path):
    found = observe_folder(SMALL_COLLAPSE)
    write_observation(tmp_path / "one.h5", found)
    read = read_observation(tmp_path / "one.h5")
    assert np.abs(read.surface - found.surface).max() < 1e-6
    assert read.description == found.description
    assert read.label == "liggghts 1"


def test_distance_of_a_block_to_a_higher_one_is_the_area_between_them(tmp_path):
    found = observe_folder(write_run(tmp_path / "run", "csv"))
    higher = observe_folder(write_run(tmp_path / "other", "csv"))
    higher.surface[:] *= 1.1
    assert profile_distance(found, higher, 0.05) == pytest.approx(0.1 / 1.05, rel=1e-6)
    assert compare(found, [found]).distances[0].distance == 0.0


@pytest.mark.parametrize(
    ("distance", "expected"),
    [
        (0.06, Verdict.INDISTINGUISHABLE),
        (-0.07, Verdict.ACCEPTABLE),
        (0.13, Verdict.DIFFERS),
        (np.nan, Verdict.DIFFERS),
    ],
)
def test_verdicts(distance, expected):
    assert verdict(distance, 0.06) is expected


def test_a_surface_table_is_a_reference(tmp_path):
    path = tmp_path / "experiment.csv"
    path.write_text("# grain_diameter = 0.003\nt,x,h\n0,-0.3,0\n0,0,0.1\n0,0.3,0\n")
    found = load_reference(path)
    assert found.of("height")[0] == pytest.approx(0.1, abs=2e-3)
    assert found.of("runout")[0] == pytest.approx(0.3 * (1 - 0.03), abs=1e-3)


def _truncate(path: Path) -> None:
    lines = path.read_text().splitlines()
    path.write_text("\n".join(lines[: len(lines) // 2]) + "\n")


def _in_millimetres(path: Path) -> None:
    lines = path.read_text().splitlines()
    rows = [line.split(",") for line in lines[1:]]
    scaled = [",".join([*row[:2], *(str(1e3 * float(value)) for value in row[2:])]) for row in rows]
    path.write_text("\n".join([lines[0], *scaled]) + "\n")


def _mixed(path: Path) -> None:
    path.write_text(path.read_text().replace("\n0,1,", "\n0,2,", 1))


def _flat(path: Path) -> None:
    lines = path.read_text().splitlines()
    rows = [line.split(",") for line in lines[1:]]
    flat = [",".join([*row[:3], "0", *row[4:]]) for row in rows]
    path.write_text("\n".join([lines[0], *flat]) + "\n")


def _without_radius(path: Path) -> None:
    path.write_text(path.read_text().replace("radius", "size"))


FAULTS = {
    "truncated": ("csv", _truncate, "grains at t = 0.1 s"),
    "truncated liggghts": ("liggghts", _truncate, "truncated"),
    "truncated vtk": ("vtk", lambda path: path.write_bytes(path.read_bytes()[:300]), "truncated|cannot be read"),
    "truncated hdf5": ("hdf5", lambda path: path.write_bytes(path.read_bytes()[:3000]), "cannot be read"),
    "empty": ("yade", lambda path: path.write_text(""), "is empty"),
    "millimetres": ("csv", _in_millimetres, "millimetres"),
    "mixed types": ("csv", _mixed, "mobile_types"),
    "two-dimensional": ("csv", _flat, "three dimensions"),
    "no radius": ("csv", _without_radius, "no column 'radius'"),
    "no number": ("csv", lambda path: path.write_text(path.read_text().replace("\n3,1,", "\n3,one,")), "one"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_dump_is_refused_in_one_line(tmp_path, fault):
    form, spoil, message = FAULTS[fault]
    folder = write_run(tmp_path / "run", form)
    file = json.loads((folder / "run.json").read_text())["frames"][1]["file"]
    spoil(folder / file)
    with pytest.raises(InputError, match=message) as caught:
        observe_folder(folder)
    assert "\n" not in str(caught.value)
    assert file in str(caught.value)
