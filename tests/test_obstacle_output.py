"""What a run tells of its obstacles: forces, outlines for ParaView, pictures; and that it resumes with them."""

import csv
import math

import numpy as np
import pytest
from matplotlib.figure import Figure
from scenes_for_tests import MU_I_LC, changed
from trimesh import Trimesh

from grainlaw.mpm_core import Scene, run
from grainlaw.mpm_core.obstacles import surface as surfaces
from grainlaw.mpm_core.obstacles.motion import Steady, at_rest
from grainlaw.mpm_core.obstacles.obstacle import Obstacle
from grainlaw.mpm_core.obstacles.outline import outline_of
from grainlaw.mpm_core.output.cut import Cut
from grainlaw.mpm_core.output.forces import force_columns, read_forces
from grainlaw.mpm_core.output.frame_series import read_collection
from grainlaw.mpm_core.output.history import read_history
from grainlaw.mpm_core.output.obstacle_drawing import boxes_within, draw_obstacles
from grainlaw.mpm_core.output.obstacle_series import OBSTACLES_NAME, obstacles_at
from grainlaw.mpm_core.output.vtp import ObstacleFrame, read_vtp
from grainlaw.mpm_core.space import AXISYMMETRIC, PLANE_STRAIN, THREE_D

# Sand on a shelf, over it a plate that rises, beside it a gate that is taken away.
SHELF = {
    "gravity": [0.0, -9.8],
    "grid": {"cell_size": 0.05, "upper": [1.0, 1.0]},
    "time": {"end": 0.2},
    "material": {"mu_i_lc": MU_I_LC},
    "body": [
        {
            "material": "mu_i_lc",
            "density": 1500.0,
            "shape": {"kind": "rectangle", "lower": [0.0, 0.2], "upper": [1.0, 0.5]},
            "initial_stress": {"kind": "geostatic"},
        }
    ],
    "obstacle": [
        {"name": "shelf", "friction": 0.5, "shape": {"kind": "rectangle", "lower": [-0.1, 0.0], "upper": [1.1, 0.2]}},
        {
            "name": "plate",
            "friction": 0.5,
            "shape": {"kind": "disc", "center": [0.5, 0.75], "radius": 0.1},
            "velocity": [0.0, 0.5],
        },
        {
            "name": "gate",
            "friction": 0.5,
            "shape": {"kind": "rectangle", "lower": [0.05, 0.6], "upper": [0.2, 0.75]},
            "until": 0.09,
        },
    ],
    "output": {"interval": 0.04, "history_interval": 0.02, "fields": ["pressure"]},
}
WEIGHT = 1500.0 * 0.3 * 9.8
DOMAIN = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("shelf") / "run"
    run(Scene.from_dict(SHELF), path)
    return path


def test_forces_are_means_between_rows_and_carry_the_weight(folder):
    forces, history = read_forces(folder), read_history(folder)
    np.testing.assert_array_equal(forces["t"], history["t"])
    assert -forces["shelf_force_y"][5:].mean() == pytest.approx(WEIGHT, rel=5e-3)
    np.testing.assert_allclose(forces["plate_y"], 0.75 + 0.5 * forces["t"])
    assert not forces["plate_force_y"].any()
    there = forces["t"] < 0.09
    assert np.isfinite(forces["gate_x"][there]).all()
    assert np.isnan(forces["gate_force_x"][~there][1:]).all()
    with (folder / "quantities.csv").open() as table:
        units = {row["name"]: row["unit"] for row in csv.DictReader(table) if row["file"] == "forces.csv"}
    assert (units["shelf_force_y"], units["shelf_torque"], units["plate_y"]) == ("N/m", "N m/m", "m")


def test_each_space_has_its_forces():
    names = {space: [column.name for column in force_columns(space, ["it"])] for space in (AXISYMMETRIC, THREE_D)}
    assert names[AXISYMMETRIC] == ["t", "it_force_x", "it_force_y", "it_x", "it_y"]
    assert len(names[THREE_D]) == 10
    assert {column.unit for column in force_columns(PLANE_STRAIN, [])} == set()


def test_outlines_follow_their_obstacles(folder):
    files = read_collection(folder, OBSTACLES_NAME)
    times = [file.time for file in read_collection(folder)]
    assert sorted({file.time for file in files}) == times
    assert len(list(folder.glob("obstacle_shelf*.vtp"))) == len(list(folder.glob("obstacle_gate*.vtp"))) == 1
    assert len(list(folder.glob("obstacle_plate_*.vtp"))) == len(times)
    for time in times:
        found = obstacles_at(folder, time)
        assert len(found) == (3 if time < 0.09 else 2)
        middle = found[1].outline.points.mean(axis=0)
        np.testing.assert_allclose(middle, [0.5, 0.75 + 0.5 * time, 0.0], atol=1e-9)
    # cut off at the sides of the domain
    assert read_vtp(folder / "obstacle_shelf.vtp").outline.points[:, 0].tolist().count(0.0) == 2


def test_paraview_reads_what_is_written(folder):
    import pyvista

    reader = pyvista.get_reader(str(folder / OBSTACLES_NAME))
    reader.set_active_time_value(reader.time_values[-1])
    blocks = reader.read()
    shelf, disc = blocks[0], blocks[1]
    assert shelf.area == pytest.approx(0.2)
    assert disc.area == pytest.approx(0.01 * math.pi, rel=2e-3)


def test_a_run_with_obstacles_resumes_to_the_same_bits(folder, tmp_path):
    half = tmp_path / "half"
    run(Scene.from_dict(changed(SHELF, {"time.end": 0.1})), half)
    run(Scene.from_dict(SHELF), half, resume=True)
    assert sorted(path.name for path in half.iterdir()) == sorted(path.name for path in folder.iterdir())
    for path in [*folder.glob("*.vtp"), folder / OBSTACLES_NAME, folder / "forces.csv", *folder.glob("*.vtu")]:
        assert path.read_bytes() == (half / path.name).read_bytes()


def test_pictures_show_obstacles_and_forces(folder):
    assert {"final.png", "history.png", "forces.png"} <= {path.name for path in folder.glob("*.png")}
    found = obstacles_at(folder, 0.0)
    axes = Figure().subplots()
    draw_obstacles(axes, found, Cut(), (0.0, 1.0, 0.0, 1.0))
    holds = [[patch.get_path().contains_point(place) for patch in axes.patches] for place in ((0.5, 0.1), (0.5, 0.75))]
    assert holds == [[True, False, False], [False, True, False]]
    # those that reach the sides of the domain do not widen the picture
    assert len(boxes_within(found, np.array([[0.0, 0.0], [1.0, 1.0]]), Cut())) == 2


def placed(surface, **options):
    motion = Steady(at_rest((0.5, 0.5, 0.5)), *np.zeros((3, 3)))
    return Obstacle("it", surface, 0.0, motion, **options)


@pytest.mark.parametrize(
    ("surface", "volume"),
    [
        (surfaces.box([0.1, 0.2, 0.3]), 0.048),
        (surfaces.cylinder(0.2, 0.3), 0.6 * 0.04 * math.pi),
        (surfaces.ball(0.3), 4.0 / 3.0 * math.pi * 0.027),
        (surfaces.half_space(), 0.5),
    ],
    ids=["box", "cylinder", "ball", "plane"],
)
def test_triangles_enclose_the_volume_of_a_shape(surface, volume):
    outline = outline_of(placed(surface), *DOMAIN)
    solid = Trimesh(outline.points, np.array(outline.faces))
    assert solid.is_watertight
    assert solid.volume == pytest.approx(volume, rel=5e-3)


def test_a_cut_through_a_ball_is_a_disc_and_a_container_is_all_around():
    ball = outline_of(placed(surfaces.ball(0.3)), *DOMAIN)
    axes = Figure().subplots()
    cut = Cut(0, 2, 1, 0.5)
    draw_obstacles(axes, [ObstacleFrame(0.0, hollow, ball) for hollow in (False, True)], cut, (0.0, 1.0, 0.0, 1.0))
    solid, hollow = (patch.get_path() for patch in axes.patches)
    assert solid.contains_point((0.5, 0.79))
    assert not solid.contains_point((0.5, 0.81))
    assert np.ptp(hollow.to_polygons()[0], axis=0).min() > 1.0
    assert len(hollow.to_polygons()) == 2


def test_the_other_half_of_a_section_is_its_mirror_image():
    disc = Obstacle("it", surfaces.ball(0.1), 0.0, Steady(at_rest((0.5, 0.5)), *np.zeros((3, 3))))
    axes = Figure().subplots()
    frame = ObstacleFrame(0.0, False, outline_of(disc, (0.0, 0.0), (1.0, 1.0)))
    draw_obstacles(axes, [frame], Cut(is_mirrored=True), (-1.0, 1.0, 0.0, 1.0))
    (patch,) = axes.patches
    assert patch.get_path().contains_point((0.5, 0.5))
    assert patch.get_path().contains_point((-0.5, 0.5))
    assert not patch.get_path().contains_point((0.0, 0.5))
